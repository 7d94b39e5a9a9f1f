"""Goals in a file: any pose file, or places on the table with the yaw of a tool that points down."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vision_robot.arm.workspace import tool_down
from vision_robot.errors import BadPoseFile
from vision_robot.geometry import SE3
from vision_robot.reading import csv_rows, json_tree, number, read_text

__all__ = ["Goals", "read_goals"]

LENGTHS = {"x_mm": 1e-3, "x_cm": 1e-2, "x_m": 1.0}
ANGLES = {"yaw_deg": np.pi / 180, "yaw_rad": 1.0}
OTHER_TURNS = ("roll", "pitch", "qw", "qx", "rx", "r1", "m0")


@dataclass(frozen=True)
class Goals:
    """Poses of the tool, as a file gives them, and the same read in the other order of quaternions."""

    poses: SE3
    where: tuple[str, ...]
    """Line or entry of each in the file."""
    order: str = ""
    """Order in which quaternions were read; empty where there are none."""
    other_order: str = ""
    other_poses: SE3 | None = None


def read_goals(path: Path | str) -> Goals:
    """Read goals from CSV or JSON. Raises BadPoseFile.

    Columns x_mm, y_mm, z_mm, yaw_deg (or x_m, yaw_rad ...) are places for a tool that points down; else
    whatever a pose file may hold: a position with a quaternion, rotation vector, angles or a matrix.
    """
    from vision_robot.calibrate.hand_eye.pose_file import read_poses

    path = Path(path)
    named = _places(path, _rows(path))
    if named is not None:
        return named
    table = read_poses(path)
    if not table.has_poses:
        raise BadPoseFile(
            path,
            f"its columns ({', '.join(table.joint_names)}) hold no poses: x_mm, y_mm, z_mm and yaw_deg for a "
            "tool that points down, or x, y, z with qw, qx, qy, qz or rx, ry, rz or roll, pitch, yaw or r11 "
            ".. r33",
        )
    poses, reading = table.base_from_wrist, table.reading
    if reading.kind != "quaternion":
        return Goals(poses, table.rows)
    other = "xyzw" if reading.order == "wxyz" else "wxyz"
    turned = table.read_as(replace(reading, order=other)).base_from_wrist
    return Goals(poses, table.rows, reading.order, other, turned)


def _rows(path: Path) -> list[tuple[str, dict[str, object]]]:
    """Where each row stands and its cells by lower-case name; empty where the file is no such table."""
    text = read_text(path, BadPoseFile)
    if text.lstrip()[:1] in ("[", "{"):
        tree = json_tree(text, path, BadPoseFile)
        listed = tree if isinstance(tree, list) else [tree]
        if not all(isinstance(row, dict) for row in listed):
            return []
        return [(f"goal {k}", _lower(row)) for k, row in enumerate(listed, start=1)]
    # Remarks are emptied, not taken out, so that the lines keep their numbers.
    lines = ["" if line.lstrip().startswith("#") else line for line in text.splitlines()]
    table = [row for row in csv_rows("\n".join(lines), path, BadPoseFile) if any(map(str.strip, row[1]))]
    return [
        (f"line {line}", _lower(dict(zip(table[0][1], cells, strict=False)))) for line, cells in table[1:]
    ]


def _lower(row: Mapping[str, object]) -> dict[str, object]:
    return {str(key).strip().lower(): value for key, value in row.items()}


def _places(path: Path, rows: list[tuple[str, dict[str, object]]]) -> Goals | None:
    """Goals of places and yaws; None where the rows hold anything else."""
    keys = set(rows[0][1]) if rows else set()
    first = next((name for name in LENGTHS if name in keys), "")
    yaw = next((name for name in ANGLES if name in keys), "")
    names = [first.replace("x_", f"{axis}_", 1) for axis in "xyz"]
    if not first or not yaw or not set(names) <= keys or any(key.startswith(OTHER_TURNS) for key in keys):
        return None
    numbers = np.array([[_number(path, where, row, name) for name in (*names, yaw)] for where, row in rows])
    turns = tool_down(numbers[:, 3] * ANGLES[yaw])
    return Goals(SE3(turns, numbers[:, :3] * LENGTHS[first]), tuple(where for where, _ in rows))


def _number(path: Path, where: str, row: Mapping[str, object], name: str) -> float:
    value = row.get(name)
    found = number(str(value))
    if found is None or np.isnan(found):
        raise BadPoseFile(path, f"{where}: {name} is {str(value)[:40]!r}, not a finite number")
    return found
