"""`vr ik stream`: joint values, or poses, to the arm's microcontroller, each row in its time."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.arm_choice import ArmOption, Base, Limit, Tool, Wrist
from vision_robot_cli.options import Json

__all__ = ["ik_stream"]


def ik_stream(
    table: Annotated[
        Path,
        typer.Argument(
            help="CSV: time_s and a column a joint, its unit in its name (d1_mm, theta2_deg); with --poses "
            "any goals that vr ik solve reads."
        ),
    ],
    port: Annotated[
        str | None,
        typer.Option("--port", help="Serial port: /dev/ttyACM0, COM3. Without it the table is only checked."),
    ] = None,
    poses: Annotated[
        bool,
        typer.Option("--poses", help="Send poses of the tool; the microcontroller solves for the joints."),
    ] = False,
    period: Annotated[
        float, typer.Option(help="Seconds from pose to pose where the file has no column time_s.")
    ] = 1.0,
    station: Annotated[
        Path | None, typer.Option(help="Pose file of base_from_station; --poses are then on the station.")
    ] = None,
    baud: Annotated[int, typer.Option(help="Bits per second.")] = 115200,
    rate: Annotated[
        float, typer.Option(help="Speed of playing: 0.5 is half as fast as the table says.")
    ] = 1.0,
    timeout: Annotated[float, typer.Option(help="Seconds to wait for an answer before sending again.")] = 0.1,
    tries: Annotated[int, typer.Option(help="How often a command is sent before giving up.")] = 5,
    silence: Annotated[
        float | None,
        typer.Option(
            help="Seconds without a command after which the microcontroller stops the arm itself; 0: never. "
            "Else a second more than the longest step of the table."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="CSV of the joints the microcontroller answered.")
    ] = None,
    arm: ArmOption = "column",
    tool: Tool = None,
    wrist: Wrist = None,
    base: Base = None,
    limit: Limit = None,
    json: Json = False,
) -> None:
    """Play a table to a microcontroller that runs the code of `vr ik export`.

    Joints are checked against the arm's limits before anything moves, and the arm is told to stop when
    anything goes wrong or Ctrl-C is pressed. The microcontroller must hold the same arm: fingerprints are
    compared.

    Example: vr ik stream moves.csv
    Example: vr ik stream moves.csv --port /dev/ttyACM0 --rate 0.5
    Example: vr ik stream goals.csv --poses --port COM3
    """
    from vision_robot.errors import BadParameter
    from vision_robot_cli import stream_table
    from vision_robot_cli.arm_choice import arm_of
    from vision_robot_cli.output import emit_json

    for option, value in (("--rate", rate), ("--period", period)):
        if not value > 0:
            raise BadParameter(option, value, "above 0")
    if station and not poses:
        raise BadParameter("--station", str(station), "given together with --poses")
    robot = arm_of(arm, tool, wrist, base, limit)
    rows = stream_table.poses(table, station, period) if poses else stream_table.joints(table, robot)
    told: dict[str, object] = {"rows": len(rows), "duration_s": float(rows.time_s[-1]) / rate, "port": port}
    if port is not None:
        quiet = stream_table.longest_step_s(rows) / rate + 1 if silence is None else silence
        wait = {"timeout_s": timeout, "tries": tries, "silence_s": quiet if quiet <= 65 else 0.0}
        told |= stream_table.played(robot, rows, port, baud, rate, wait, out)
    if json:
        emit_json("ik.stream", told)
    elif port is None:
        kind = "poses" if poses else "rows, all inside the limits,"
        print(f"{table}: {len(rows)} {kind} over {told['duration_s']:.3f} s")
    else:
        late = f"{told['latency_p50_ms']:.1f} ms (median) to {told['latency_max_ms']:.1f} ms"
        print(f"{port}: {len(rows)} commands carried out, {told['resent']} sent again, answered {late} late")
