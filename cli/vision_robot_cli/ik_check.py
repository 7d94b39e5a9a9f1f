"""`vr ik check`: what an arm is, whether its kinematics hold together, where it reaches."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.arm_options import ArmBase, ArmFile, ArmLimits, ArmTool
from vision_robot_cli.options import Json, Report, Seed

__all__ = ["ik_check"]


def ik_check(
    arm: ArmFile = "column",
    tool: ArmTool = None,
    base: ArmBase = None,
    limit: ArmLimits = None,
    targets: Annotated[int, typer.Option(help="Targets drawn inside the limits.")] = 4000,
    height: Annotated[
        str | None, typer.Option(help="Height over the base of the map from above; else the widest.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Write the map from above as an SVG drawing.")
    ] = None,
    report: Report = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Check an arm's model: kind, limits, forward against inverse kinematics, workspace.

    Example: vr ik check --arm my_arm.xml --report arm.html
    """
    import shlex
    import sys

    from vision_robot.arm.consistency import check_consistency
    from vision_robot.arm.ik import InverseKinematics
    from vision_robot.arm.workspace import workspace
    from vision_robot.errors import BadParameter
    from vision_robot.files import check_place, write_text
    from vision_robot_cli import ik_check_output
    from vision_robot_cli.arm_options import arm_of, height_of
    from vision_robot_cli.output import emit_json, note

    for place in (out, report):
        if place:
            check_place(place)
    if targets < 1:
        raise BadParameter("--targets", targets, "1 or more")
    at = height_of(height) if height else None
    robot = arm_of(arm, tool, base, limit)
    checks = check_consistency(robot, targets=targets, seed=seed)
    found = workspace(InverseKinematics(robot), height_m=at)
    if out:
        from vision_robot.report.workspace_figures import workspace_figures

        write_text(out, workspace_figures(found)[0].svg)
        note(f"map written to {out}")
    if report:
        from vision_robot.report.arm import arm_page
        from vision_robot.report.page import write_page

        command = shlex.join(["vr", *sys.argv[1:]])
        write_page(arm_page(robot, checks=checks, found=found, command=command, seed=seed), report)
        note(f"report written to {report}")
    if json:
        emit_json("ik.check", ik_check_output.as_json(robot, checks, found, seed))
    else:
        print(ik_check_output.as_text(robot, checks, found))
