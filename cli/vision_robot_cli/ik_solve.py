"""`vr ik solve`: poses of the tool in, joint values out."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.arm_choice import ArmOption, Base, Limit, TaskName, Tool, Wrist
from vision_robot_cli.options import Json, Out

__all__ = ["ik_solve"]


def ik_solve(
    poses: Annotated[
        Path | None,
        typer.Argument(help="CSV or JSON: x_mm, y_mm, z_mm, yaw_deg (tool down), or any poses of the tool."),
    ] = None,
    position: Annotated[
        str | None, typer.Option(help="One goal instead of a file: X,Y,Z with the unit, 300,0,100mm.")
    ] = None,
    yaw: Annotated[str, typer.Option(help="Yaw of the tool, pointing down, for --position.")] = "0deg",
    quaternion: Annotated[
        str | None, typer.Option(help="Orientation for --position: wxyz=0,1,0,0 or xyzw=1,0,0,0.")
    ] = None,
    station: Annotated[
        Path | None, typer.Option(help="Pose file of base_from_station; goals are then on the station.")
    ] = None,
    arm: ArmOption = "column",
    tool: Tool = None,
    wrist: Wrist = None,
    base: Base = None,
    limit: Limit = None,
    task: TaskName = "pose",
    method: Annotated[str, typer.Option(help="auto, closed-form or numeric.")] = "auto",
    near: Annotated[
        str | None, typer.Option(help="Present joints, to stay near: d1=100mm,theta2=30deg.")
    ] = None,
    prefer: Annotated[
        str,
        typer.Option(
            help="Which of several branches: near (--near), margin (far from limits), or free (touching "
            "nothing in the arm's MuJoCo model)."
        ),
    ] = "near",
    every: Annotated[bool, typer.Option("--all", help="All branches of each goal, one row each.")] = False,
    max_unreached: Annotated[
        int | None, typer.Option(help="Exit with 3 when more goals than this are not reached.")
    ] = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Joint values that bring the tool to goal poses, or why none do.

    Example: vr ik solve --position 350,100,150mm --yaw 30deg
    Example: vr ik solve goals.csv -o joints.csv
    """
    from vision_robot.files import check_place
    from vision_robot_cli import ik_input, ik_output
    from vision_robot_cli.arm_choice import arm_of
    from vision_robot_cli.arm_quantities import joints_of
    from vision_robot_cli.output import check_limit, emit_json

    if out:
        check_place(out)
    chosen = ik_input.choices(task, method, prefer)
    robot = arm_of(arm, tool, wrist, base, limit)
    goals = ik_input.goals(poses, position, yaw, quaternion, station)
    present = joints_of(near, robot, "--near") if near else None
    answer = ik_input.solved(robot, goals, chosen, present, arm, every=every)
    if out:
        ik_output.write_joints(answer, out)
    if json:
        emit_json("ik.solve", ik_output.as_json(answer))
    else:
        print(ik_output.as_text(answer))
    check_limit("goals not reached", answer.unreached, max_unreached)
