"""Which columns of a pose file are what."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vision_robot.calibrate.hand_eye.pose_table import LENGTHS, PoseTable, Reading
from vision_robot.errors import BadPoseFile
from vision_robot.reading import number
from vision_robot.types import Array, Float

__all__ = ["columns_of", "table_of"]

PICTURE = ("image", "picture", "file", "filename", "name", "view", "photo", "frame")
TIME = ("time", "time_s", "timestamp", "t", "stamp", "id", "index", "number")
POSITION = (("x", "y", "z"), ("tx", "ty", "tz"), ("px", "py", "pz"), ("pos_x", "pos_y", "pos_z"))
QUATERNION = (("qw", "qx", "qy", "qz"), ("q_w", "q_x", "q_y", "q_z"), ("ow", "ox", "oy", "oz"))
PLAIN_QUATERNION = (("q0", "q1", "q2", "q3"), ("q1", "q2", "q3", "q4"))
ROTVEC = (("rx", "ry", "rz"), ("rvx", "rvy", "rvz"), ("wx", "wy", "wz"))
EULER = {
    ("roll", "pitch", "yaw"): ("xyz", "rad"),
    ("a", "b", "c"): ("ZYX", "deg"),
    ("w", "p", "r"): ("xyz", "deg"),
    ("e1", "e2", "e3"): ("xyz", "deg"),
}
"""Euler angles by the names of their columns: order, and the unit where no name says it (A B C is KUKA's,
W P R Fanuc's)."""

UNNAMED = {
    6: ("x", "y", "z", "rx", "ry", "rz"),
    7: ("x", "y", "z", "qx", "qy", "qz", "qw"),
    8: ("time", "x", "y", "z", "qx", "qy", "qz", "qw"),
    12: tuple(f"m{i}{j}" for i in range(3) for j in range(4)),
    16: tuple(f"m{i}{j}" for i in range(4) for j in range(4)),
}


@dataclass(frozen=True)
class Column:
    """Numbers, or texts, under one name, with the unit the name ended in."""

    name: str
    cells: tuple[str, ...]
    unit: str
    rows: tuple[str, ...]
    source: str

    @property
    def numbers(self) -> Float[Array, "n"]:
        """The cells as finite numbers; raises BadPoseFile naming the first that is none."""
        return np.array([self._value(text, row) for text, row in zip(self.cells, self.rows, strict=True)])

    @property
    def is_text(self) -> bool:
        """Whether no cell is a number: a remark, a date."""
        return all(number(cell) is None for cell in self.cells)

    def _value(self, text: str, row: str) -> float:
        value = number(text)
        if value is None or not np.isfinite(value):
            raise BadPoseFile(self.source, f"{row}: {self.name} is {text[:40]!r}, not a finite number")
        return value


def columns_of(
    header: Sequence[str] | None, cells: Sequence[Sequence[str]], rows: Sequence[str], path: Path
) -> Mapping[str, Column]:
    """Columns by their plain names; picture names that stand first in a file without header are found."""
    width = len(cells[0])
    if header is None:
        named = width - 1 in UNNAMED and number(cells[0][0]) is None
        names = ("image", *UNNAMED[width - 1]) if named else UNNAMED.get(width)
        if names is None:
            raise BadPoseFile(
                path,
                f"it has {width} numbers a row and no names over them: 6, 7, 8, 12 or 16 can be told apart; "
                "put a first line with names such as image,x_m,y_m,z_m,qw,qx,qy,qz",
            )
        header = names
    columns: dict[str, Column] = {}
    for j, full in enumerate(header):
        name, unit = full.strip().lower(), ""
        if name not in ("time_s",):
            stem, mark, ending = name.rpartition("_")
            if mark and ending in (*LENGTHS, "deg", "rad"):
                name, unit = stem, ending
        if name in columns:
            raise BadPoseFile(path, f"two columns are called {name}")
        columns[name] = Column(full, tuple(row[j] for row in cells), unit, tuple(rows), str(path))
    return columns


def table_of(columns: Mapping[str, Column], rows: Sequence[str], path: Path) -> PoseTable:
    """The pose table; raises BadPoseFile where neither poses nor joint values are there."""
    picture = next((columns[name] for name in PICTURE if name in columns), None)
    used = {*PICTURE, *TIME}
    inverse = "wrist_from_base" in columns
    used.add("wrist_from_base")
    position = next((names for names in POSITION if set(names) <= set(columns)), None)
    matrix = _matrix_names(columns)
    shift, turn, reading = np.zeros((0, 3)), np.zeros((0, 3)), Reading("rotvec")
    kind = _turn_names(columns)
    if matrix and (position or matrix.shift):
        names = position or matrix.shift
        shift = _stack(columns, names)
        turn = _stack(columns, matrix.turn)
        reading = Reading("matrix", length=_unit(columns, names, path, "m"), inverse=inverse)
        used |= {*names, *matrix.turn, *matrix.rest}
    elif position and kind:
        names, what, order, unit = kind
        shift, turn = _stack(columns, position), _stack(columns, names)
        angle = "rad" if what == "quaternion" else _unit(columns, names, path, unit)
        reading = Reading(what, order, _unit(columns, position, path, "m"), angle, inverse)
        used |= {*position, *names}
    joints = [name for name, column in columns.items() if name not in used and not column.is_text]
    if not len(shift) and not joints:
        raise BadPoseFile(
            path,
            f"its columns ({', '.join(columns)}) hold no pose: x, y, z with qw, qx, qy, qz or rx, ry, rz or "
            "roll, pitch, yaw or r11 .. r33, or joint values, are expected",
        )
    if (position or kind) and not len(shift):
        lacking = "x, y, z" if kind else "a rotation (qw.., rx.., roll.. or r11..)"
        raise BadPoseFile(path, f"its columns ({', '.join(columns)}) lack {lacking}")
    return PoseTable(
        source=str(path),
        reading=reading,
        shift=shift,
        turn=turn,
        names=picture.cells if picture else None,
        rows=tuple(rows),
        joints=np.stack([_in_si(columns[name]) for name in joints], axis=1) if joints else None,
        joint_names=tuple(joints),
    )


@dataclass(frozen=True)
class MatrixNames:
    """Columns of a matrix: its 3x3 part, its last column, the rest."""

    turn: tuple[str, ...]
    shift: tuple[str, ...]
    rest: tuple[str, ...]


def _matrix_names(columns: Mapping[str, Column]) -> MatrixNames | None:
    for letter, first in (("r", 1), ("m", 0), ("r", 0), ("m", 1)):
        square = tuple(f"{letter}{i}{j}" for i in range(first, first + 3) for j in range(first, first + 3))
        if set(square) <= set(columns):
            last = tuple(f"{letter}{i}{first + 3}" for i in range(first, first + 3))
            rest = tuple(f"{letter}{first + 3}{j}" for j in range(first, first + 4))
            return MatrixNames(square, last if set(last) <= set(columns) else (), rest)
    return None


def _turn_names(columns: Mapping[str, Column]) -> tuple[tuple[str, ...], str, str, str] | None:
    """Names, kind, order and unit of whatever tells the turn."""
    for names in QUATERNION:
        if set(names) <= set(columns):
            # In the order of the file: that is what a wrong header gets wrong.
            there = tuple(name for name in columns if name in names)
            return there, "quaternion", "".join(name[-1] for name in there), ""
    for names in ROTVEC:
        if set(names) <= set(columns):
            return names, "rotvec", "", "rad"
    for names, (order, unit) in EULER.items():
        if set(names) <= set(columns):
            return names, "euler", order, unit
    for names in PLAIN_QUATERNION:
        if set(names) <= set(columns) and not {"q5", "q6"} & set(columns):
            return names, "quaternion", "wxyz", ""
    return None


def _stack(columns: Mapping[str, Column], names: Sequence[str]) -> Float[Array, "n k"]:
    return np.stack([columns[name].numbers for name in names], axis=1)


def _unit(columns: Mapping[str, Column], names: Sequence[str], path: Path, otherwise: str) -> str:
    units = {columns[name].unit for name in names} - {""}
    if len(units) > 1:
        raise BadPoseFile(
            path, f"columns {', '.join(names)} have different units: {', '.join(sorted(units))}"
        )
    return units.pop() if units else otherwise


def _in_si(column: Column) -> Float[Array, "n"]:
    if column.unit == "deg":
        return np.radians(column.numbers)
    return column.numbers * LENGTHS.get(column.unit, 1.0)
