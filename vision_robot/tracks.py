"""Where objects were, frame by frame: one table, the same for a tracker's answer and for the truth."""

from array import array
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path

import numpy as np

from vision_robot.errors import BadTable
from vision_robot.files import write_text
from vision_robot.reading import LARGEST_TABLE, csv_rows, number, read_text
from vision_robot.types import Array, Float, Int

__all__ = ["COLUMNS", "Tracks"]

COLUMNS = (
    "frame", "time_s", "id", "u_px", "v_px", "left_px", "top_px", "width_px", "height_px", "area_px",
    "major_px", "minor_px", "yaw_deg", "x_mm", "y_mm", "vx_mm_s", "vy_mm_s",
)  # fmt: skip
"""Header of the CSV; outsiders rely on it. Further columns may follow, and are kept."""
LARGEST_WHOLE = 2.0**53
"""From here on, whole numbers run together."""


@dataclass(frozen=True)
class Tracks:
    """One row for each object in each frame, sorted by frame, then id; NaN where something is unknown.

    Pixels follow the house's convention (u right, v down, centre of the first pixel at 0); a box is
    (left, top, width, height), its left and top the outer border of the first column and row, half a
    pixel before their centres. `axes_px` are full lengths, major first. Yaw is the direction of the
    major axis from the first axis towards the second: of the work plane where there is one, else of
    the picture; it runs on past half a turn as the object turns. Positions and velocities are in
    the station's plane {S}.
    """

    frame: Int[Array, "n"]
    time_s: Float[Array, "n"]
    id: Int[Array, "n"]
    centroid_px: Float[Array, "n 2"]
    box_px: Float[Array, "n 4"]
    area_px: Float[Array, "n"]
    axes_px: Float[Array, "n 2"]
    yaw_rad: Float[Array, "n"]
    position_m: Float[Array, "n 2"]
    velocity_m_s: Float[Array, "n 2"]
    extra: Mapping[str, Float[Array, "n"]] = field(default_factory=dict)
    """Further columns by name, such as the truth's `occluded`."""

    def __post_init__(self) -> None:
        n = len(self.frame)
        for one in fields(self):
            if one.name == "extra":
                continue
            kind = np.int64 if one.name in ("frame", "id") else float
            array = np.asarray(getattr(self, one.name), dtype=kind)
            if len(array) != n:
                raise BadTable("tracks", f"{one.name} has {len(array)} rows and frame has {n}")
            object.__setattr__(self, one.name, array)

    def __len__(self) -> int:
        return len(self.frame)

    @classmethod
    def empty(cls) -> "Tracks":
        """No rows."""
        none, pairs = np.zeros(0), np.zeros((0, 2))
        return cls(none, none, none, pairs, np.zeros((0, 4)), none, pairs, none, pairs, pairs)

    @classmethod
    def joined(cls, parts: "Iterable[Tracks]") -> "Tracks":
        """The rows of several tables with the same further columns, one after the other."""
        some = [part for part in parts if len(part)]
        if not some:
            return cls.empty()
        columns = {
            one.name: np.concatenate([getattr(part, one.name) for part in some])
            for one in fields(cls)
            if one.name != "extra"
        }
        extra = {name: np.concatenate([part.extra[name] for part in some]) for name in some[0].extra}
        return cls(**columns, extra=extra)

    @property
    def ids(self) -> Int[Array, "k"]:
        """The different ids, rising."""
        return np.unique(self.id)

    def rows(self, keep: Array) -> "Tracks":
        """The rows that a mask, slice or index array picks."""
        picked = {one.name: getattr(self, one.name)[keep] for one in fields(self) if one.name != "extra"}
        return Tracks(**picked, extra={name: column[keep] for name, column in self.extra.items()})

    def columns(self) -> dict[str, Array]:
        """The table as the CSV has it: names of `COLUMNS` (px, mm, degrees), then the further ones."""
        values = (
            self.frame, self.time_s, self.id, *self.centroid_px.T, *self.box_px.T, self.area_px,
            *self.axes_px.T, np.degrees(self.yaw_rad), *1e3 * self.position_m.T, *1e3 * self.velocity_m_s.T,
        )  # fmt: skip
        return {**dict(zip(COLUMNS, values, strict=True)), **self.extra}

    def to_csv(self) -> str:
        """CSV text; unknown values are empty fields."""
        table = self.columns()
        lines = [",".join(table)]
        lines += [",".join(map(_cell, row)) for row in zip(*table.values(), strict=True)]
        return "\n".join(lines) + "\n"

    def write(self, path: Path | str) -> None:
        """Write the CSV, whole or not at all."""
        write_text(path, self.to_csv())

    @classmethod
    def read(cls, path: Path | str) -> "Tracks":
        """Read such a CSV. Raises BadTable, naming line and column, for anything else."""
        return cls.from_csv(read_text(path, BadTable, LARGEST_TABLE), path)

    @classmethod
    def from_csv(cls, text: str, source: object = "tracks") -> "Tracks":
        """The table in a CSV text; `source` is named in errors."""
        rows = csv_rows(text, source, BadTable)
        header = [name.strip() for name in next(rows, (0, []))[1]]
        missing = [name for name in ("frame", "id", "u_px", "v_px") if name not in header]
        if missing:
            raise BadTable(source, f"its first line lacks the column(s) {', '.join(missing)}")
        cells, lines = array("d"), []
        for line, row in rows:
            if len(row) != len(header):
                raise BadTable(source, f"line {line} has {len(row)} fields, the first line {len(header)}")
            cells.extend(_number(cell, source, line, name) for cell, name in zip(row, header, strict=True))
            lines.append(line)
        numbers = np.array(cells).reshape(len(lines), len(header))
        table = dict(zip(header, numbers.T, strict=True))
        known = {name: table.get(name, np.full(len(lines), np.nan)) for name in COLUMNS}
        for name in ("frame", "id"):
            whole = (np.abs(known[name]) < LARGEST_WHOLE) & (known[name] == np.rint(known[name]))
            if not whole.all():
                line = lines[int(np.flatnonzero(~whole)[0])]
                raise BadTable(source, f"line {line}: {name} must be a whole number")
        order = np.lexsort((known["id"], known["frame"]))
        c = {name: column[order] for name, column in known.items()}
        return cls(
            frame=c["frame"],
            time_s=c["time_s"],
            id=c["id"],
            centroid_px=np.stack([c["u_px"], c["v_px"]], axis=1),
            box_px=np.stack([c["left_px"], c["top_px"], c["width_px"], c["height_px"]], axis=1),
            area_px=c["area_px"],
            axes_px=np.stack([c["major_px"], c["minor_px"]], axis=1),
            yaw_rad=np.radians(c["yaw_deg"]),
            position_m=np.stack([c["x_mm"], c["y_mm"]], axis=1) / 1e3,
            velocity_m_s=np.stack([c["vx_mm_s"], c["vy_mm_s"]], axis=1) / 1e3,
            extra={name: table[name][order] for name in header if name not in COLUMNS},
        )


def _cell(value: float) -> str:
    if np.isnan(value):
        return ""
    return str(int(value)) if value == int(value) else f"{value:.6f}".rstrip("0")


def _number(cell: str, source: object, line: int, column: str) -> float:
    text = cell.strip()
    if not text:
        return np.nan
    value = number(text)
    if value is None:
        raise BadTable(source, f"line {line}: {column} is {cell!r}, not a number")
    if np.isnan(value):
        raise BadTable(source, f"line {line}: {column} is {cell!r}; leave it empty where it is unknown")
    return value
