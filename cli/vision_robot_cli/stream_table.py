"""What `vr ik stream` sends, and the sending."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from vision_robot.arm import Arm
from vision_robot.arm.export_c import fingerprint
from vision_robot.arm.stream import JointTable, Link, PoseTable, SerialPort, play
from vision_robot.errors import BadTable
from vision_robot.files import check_place
from vision_robot.reading import csv_rows, number, read_text
from vision_robot_cli.goal_file import read_goals
from vision_robot_cli.output import progress

__all__ = ["joints", "longest_step_s", "played", "poses"]


def joints(path: Path, arm: Arm) -> JointTable:
    """A table of joints inside the arm's limits. Raises BadTable."""
    table = JointTable.read(path, arm.chain)
    table.check(arm.chain, path)
    return table


def poses(path: Path, station: Path | None, period_s: float) -> PoseTable:
    """Goals of a pose file; on the station where that is given. Raises BadPoseFile and BadTable."""
    goals = read_goals(path).poses
    times = _times(path)
    if times is None:
        times = period_s * np.arange(len(goals))
    if len(times) != len(goals) or not (times[0] >= 0 and (np.diff(times) > 0).all()):
        raise BadTable(path, "its column time_s must rise from 0 or later, a number in every row")
    if station is not None:
        where = read_goals(station).poses
        if len(where) != 1:
            raise BadTable(station, f"it must hold one pose, base_from_station; it holds {len(where)}")
        goals = where[0] @ goals
    return PoseTable(times, goals)


def longest_step_s(table: JointTable | PoseTable) -> float:
    """Longest time between two rows, or before the first."""
    return float(np.diff(table.time_s, prepend=0.0).max())


def _times(path: Path) -> np.ndarray | None:
    """The column time_s of a CSV; None where there is none, as in JSON."""
    text = read_text(path, BadTable)
    if text.lstrip()[:1] in ("[", "{"):
        return None
    lines = [line for line in text.splitlines() if line.strip()[:1] not in ("", "#")]
    rows = [row for _, row in csv_rows("\n".join(lines), path, BadTable)]
    names = [name.strip() for name in rows[0]] if rows else []
    if "time_s" not in names:
        return None
    column = names.index("time_s")
    times = [number(row[column]) if len(row) > column else None for row in rows[1:]]
    if None in times:
        raise BadTable(path, "its column time_s must hold a number in every row")
    return np.array(times, dtype=float)


def played(
    arm: Arm,
    table: JointTable | PoseTable,
    port: str,
    baud: int,
    rate: float,
    wait: Mapping[str, float],
    out: Path | None,
) -> dict[str, object]:
    """Send the table; what came of it, as the keys of `--json`."""
    if out is not None:
        check_place(out)
    with SerialPort(port, baud) as line:
        link = Link(line, len(arm), fingerprint(arm.chain), **wait)  # type: ignore[arg-type]
        link.open()
        answers = [*progress(play(link, table, rate=rate), "streaming", total=len(table))]
        damaged = link.damaged
    if out is not None:
        answered = np.array([answer.q for _, answer in answers])
        JointTable.of(arm.chain, table.time_s / rate, answered).write(out)
    late_ms = 1e3 * np.array([late for late, _ in answers])
    return {
        "carried_out": len(answers),
        "resent": link.resent,
        "damaged": damaged,
        "latency_p50_ms": float(np.median(late_ms)),
        "latency_max_ms": float(late_ms.max()),
        "out": None if out is None else str(out),
    }
