"""`vr ik stream`: a table of joint values to the arm's microcontroller, each row in its time."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vision_robot_cli.arm_choice import ArmSource, Base, Limit, Tool, Wrist, arm_of
from vision_robot_cli.options import Json

if TYPE_CHECKING:
    from vision_robot.arm import Arm
    from vision_robot.arm.stream import JointTable

__all__ = ["ik_stream"]


def ik_stream(
    arm: ArmSource,
    table: Annotated[
        Path,
        typer.Argument(help="CSV: time_s and a column a joint, its unit in its name: d1_mm, theta2_deg."),
    ],
    port: Annotated[
        str | None,
        typer.Option("--port", help="Serial port: /dev/ttyACM0, COM3. Without it the table is only checked."),
    ] = None,
    baud: Annotated[int, typer.Option(help="Bits per second.")] = 115200,
    rate: Annotated[
        float, typer.Option(help="Speed of playing: 0.5 is half as fast as the table says.")
    ] = 1.0,
    timeout: Annotated[float, typer.Option(help="Seconds to wait for an answer before sending again.")] = 0.1,
    tries: Annotated[int, typer.Option(help="How often a command is sent before giving up.")] = 5,
    silence: Annotated[
        float, typer.Option(help="Seconds without a command after which the arm stops by itself; 0: never.")
    ] = 1.0,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="CSV of the joints the microcontroller answered.")
    ] = None,
    tool: Tool = None,
    wrist: Wrist = None,
    base: Base = None,
    limit: Limit = None,
    json: Json = False,
) -> None:
    """Play a joint table to a microcontroller that runs the code of `vr ik export`.

    The table is checked against the arm's limits before anything moves, and the arm is told to stop when
    anything goes wrong or Ctrl-C is pressed. The microcontroller must hold the same arm: fingerprints are
    compared.

    Example: vr ik stream column joints.csv --port /dev/ttyACM0 --rate 0.5
    """
    from vision_robot.arm.stream import JointTable
    from vision_robot.errors import BadParameter
    from vision_robot_cli.output import emit_json

    robot = arm_of(arm, tool, wrist, base, limit)
    if rate <= 0:
        raise BadParameter("--rate", rate, "above 0")
    joints = JointTable.read(table, robot.chain)
    joints.check(robot.chain, table)
    result: dict[str, object] = {"rows": len(joints), "duration_s": float(joints.time_s[-1]) / rate}
    if port is not None:
        result |= played(robot, joints, port, baud, rate, (timeout, tries, silence), out)
    result["port"] = port
    if json:
        emit_json("ik.stream", result)
    elif port is None:
        print(f"{table}: {len(joints)} rows over {result['duration_s']:.3f} s, all inside the limits")
    else:
        late = f"{result['latency_p50_ms']:.1f} ms (median) to {result['latency_max_ms']:.1f} ms"
        done = f"{len(joints)} commands carried out, {result['resent']} sent again"
        print(f"{port}: {done}, answered {late} after their time")


def played(
    robot: "Arm",
    joints: "JointTable",
    port: str,
    baud: int,
    rate: float,
    patience: tuple[float, int, float],
    out: Path | None,
) -> dict[str, object]:
    """Send the table; what came of it, as the keys of `--json`."""
    import numpy as np

    from vision_robot.arm.export_c import fingerprint
    from vision_robot.arm.stream import JointTable, Link, SerialPort, play
    from vision_robot.files import check_place
    from vision_robot_cli.output import progress

    if out is not None:
        check_place(out)
    timeout_s, tries, silence_s = patience
    with SerialPort(port, baud) as line:
        link = Link(
            line, len(robot), fingerprint(robot.chain), timeout_s=timeout_s, tries=tries, silence_s=silence_s
        )
        link.open()
        answers = [*progress(play(link, joints, rate=rate), "streaming", total=len(joints))]
        damaged = link.damaged
    if out is not None:
        JointTable.of(robot.chain, joints.time_s, np.array([answer.q for _, answer in answers])).write(out)
    late_ms = 1e3 * np.array([late for late, _ in answers])
    return {
        "carried_out": len(answers),
        "resent": link.resent,
        "damaged": damaged,
        "latency_p50_ms": float(np.median(late_ms)),
        "latency_max_ms": float(late_ms.max()),
        "out": None if out is None else str(out),
    }
