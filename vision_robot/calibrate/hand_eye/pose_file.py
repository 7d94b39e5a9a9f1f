"""Files of robot poses: CSV or JSON, one pose a row, meaning told by the columns' names.

Position: ``x y z`` (or tx.., px..). Turn, one of: ``qw qx qy qz``; ``rx ry rz`` (rotation vector);
``roll pitch yaw``, ``a b c``, ``w p r`` (Euler angles); ``r11 .. r33`` or ``m00 .. m33``. Joint values:
``j1 j2 ..`` or the joints' own names. Picture: ``image``. A unit may end a name: x_mm, rx_deg, d1_mm.
Without names the count of numbers tells: 6 x y z and rotation vector; 7 the same with quaternion xyzw; 8 with
a time before (TUM); 12 or 16 matrix.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from vision_robot.calibrate.hand_eye.pose_columns import columns_of, table_of
from vision_robot.calibrate.hand_eye.pose_table import PoseTable
from vision_robot.errors import BadPoseFile
from vision_robot.reading import csv_rows, json_tree, number, read_text

__all__ = ["read_poses"]


def read_poses(path: Path | str) -> PoseTable:
    """Read a pose file; raises BadPoseFile naming line and column of what cannot be used."""
    path = Path(path)
    text = read_text(path, BadPoseFile)
    if not text.strip():
        raise BadPoseFile(path, "it is empty")
    if text.lstrip()[0] in "[{":
        header, cells, rows = _from_json(text, path)
    else:
        header, cells, rows = _from_lines(text, path)
    if not cells:
        raise BadPoseFile(path, "it holds no pose")
    return table_of(columns_of(header, cells, rows, path), rows, path)


def _from_lines(text: str, path: Path) -> tuple[list[str] | None, list[list[str]], list[str]]:
    """Header if there is one, cells, and where each row stands."""
    lines = [
        (i, line)
        for i, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise BadPoseFile(path, "it holds no pose")
    mark = next((mark for mark in (",", ";", "\t") if mark in lines[0][1]), None)

    def split(line: str) -> list[str]:
        found = next(csv_rows(line, path, BadPoseFile, mark), (0, []))[1] if mark else line.split()
        return [cell.strip() for cell in found]

    table = [(i, split(line)) for i, line in lines]
    first = table[0][1]
    has_header = sum(number(cell) is not None for cell in first) <= 1 and len(first) > 1
    header = first if has_header else None
    body = table[1:] if has_header else table
    width = len(first)
    for i, cells in body:
        if len(cells) != width:
            raise BadPoseFile(path, f"line {i} has {len(cells)} fields, the first line {width}")
    return header, [cells for _, cells in body], [f"line {i}" for i, _ in body]


def _from_json(text: str, path: Path) -> tuple[list[str], list[list[str]], list[str]]:
    """The same from a list of objects, under the key `poses` or `views` or at the top."""
    tree = json_tree(text, path, BadPoseFile)
    if isinstance(tree, Mapping):
        tree = next((tree[key] for key in ("poses", "views", "data") if key in tree), None)
    if not isinstance(tree, list):
        raise BadPoseFile(path, "a list of poses is expected, at the top or under `poses`")
    flat = []
    for i, value in enumerate(tree):
        item = {"matrix": value} if isinstance(value, list) else value
        if not isinstance(item, Mapping):
            raise BadPoseFile(path, f"pose {i + 1}: an object or a matrix is expected")
        flat.append(dict(_flattened(item)))
    header = list(flat[0]) if flat else []
    for i, item in enumerate(flat):
        if list(item) != header:
            raise BadPoseFile(path, f"pose {i + 1} has other keys than pose 1: {', '.join(item)}")
    return (
        header,
        [[str(item[name]) for name in header] for item in flat],
        [f"pose {i + 1}" for i in range(len(flat))],
    )


SPELT = {
    "translation": ("x", "y", "z"),
    "position": ("x", "y", "z"),
    "rotvec": ("rx", "ry", "rz"),
    "quaternion": ("q0", "q1", "q2", "q3"),
    "quaternion_wxyz": ("qw", "qx", "qy", "qz"),
    "quaternion_xyzw": ("qx", "qy", "qz", "qw"),
    "euler": ("e1", "e2", "e3"),
    "rpy": ("roll", "pitch", "yaw"),
}
"""Lists of numbers, by the columns they stand for."""

UNITS = ("_mm", "_m", "_cm", "_in", "_deg", "_rad")


def _flattened(item: Mapping) -> Sequence[tuple[str, object]]:
    """Columns of one JSON pose; objects inside, such as base_from_wrist, are opened."""
    columns: list[tuple[str, object]] = []
    for key, value in item.items():
        name, unit = str(key).lower(), ""
        for ending in UNITS:
            if name.endswith(ending):
                name, unit = name.removesuffix(ending), ending
                break
        if isinstance(value, Mapping):
            columns += _flattened(value)
            if name == "wrist_from_base":
                columns.append((name, 1))
        elif isinstance(value, list):
            numbers = np.array(value, dtype=object).ravel().tolist() if _even(value) else list(value)
            if name in SPELT and len(numbers) == len(SPELT[name]):
                columns += [(f"{part}{unit}", cell) for part, cell in zip(SPELT[name], numbers, strict=True)]
            elif name in ("matrix", "rotation") or len(numbers) in (9, 12, 16):
                width = 3 if len(numbers) == 9 else 4
                columns += [(f"m{k // width}{k % width}", cell) for k, cell in enumerate(numbers)]
            else:
                columns += [(f"j{k + 1}{unit}", cell) for k, cell in enumerate(numbers)]
        else:
            columns.append((f"{name}{unit}", value))
    return columns


def _even(value: list) -> bool:
    """Whether a list is flat, or rows of one length."""
    return len({len(row) if isinstance(row, list) else -1 for row in value}) == 1
