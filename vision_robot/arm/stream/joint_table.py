"""Joint values over time as a CSV: a column of seconds and one for each joint, its unit in its name."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vision_robot.errors import BadTable
from vision_robot.files import write_text
from vision_robot.geometry.chain import SerialChain
from vision_robot.reading import LARGEST_TABLE, csv_rows, number, read_text
from vision_robot.types import Array, Float

__all__ = ["JointTable"]

TIME = "time_s"
SCALES = {True: {"m": 1.0, "mm": 1e-3}, False: {"rad": 1.0, "deg": np.pi / 180}}
"""To metres for what slides, to radians for what turns."""


@dataclass(frozen=True)
class JointTable:
    """Where every joint is to be, and when; times rise."""

    joint_names: tuple[str, ...]
    slides: tuple[bool, ...]
    time_s: Float[Array, "n"]
    q: Float[Array, "n joints"]
    """[m or rad]"""

    def __post_init__(self) -> None:
        time, q = np.asarray(self.time_s, dtype=float), np.asarray(self.q, dtype=float)
        if q.shape != (len(time), len(self.joint_names)):
            raise BadTable(
                "joint table", f"{q.shape} values for {len(time)} times x {len(self.joint_names)} joints"
            )
        if not (np.isfinite(time).all() and (time >= 0).all() and (np.diff(time) > 0).all()):
            raise BadTable(
                "joint table", f"its times must rise from 0 s or later; row {_first_bad(time)} does not"
            )
        if not np.isfinite(q).all():
            row = int(np.flatnonzero(~np.isfinite(q).all(axis=1))[0]) + 1
            raise BadTable("joint table", f"row {row} has a value that is not finite")
        object.__setattr__(self, "time_s", time)
        object.__setattr__(self, "q", q)
        object.__setattr__(self, "slides", tuple(bool(slides) for slides in self.slides))

    def __len__(self) -> int:
        return len(self.time_s)

    @classmethod
    def of(cls, chain: SerialChain, time_s: Float[Array, "n"], q: Float[Array, "n joints"]) -> "JointTable":
        """A table for the joints of `chain`."""
        return cls(chain.joint_names, tuple(chain.slides), time_s, q)

    def check(self, chain: SerialChain, source: object = "joint table") -> None:
        """Raise BadTable, naming line, joint and limit, where a row leaves the arm's limits."""
        outside = (self.q < chain.limits[:, 0]) | (self.q > chain.limits[:, 1])
        if outside.any():
            row, joint = (int(index) for index in np.argwhere(outside)[0])
            unit = "m" if self.slides[joint] else "rad"
            low, high = chain.limits[joint]
            raise BadTable(
                source,
                f"line {row + 2}: {self.joint_names[joint]} is {self.q[row, joint]:.6g} {unit}, "
                f"outside its limits {low:.6g} to {high:.6g} {unit}",
            )

    def to_csv(self) -> str:
        """CSV text in metres and radians; every number comes back exactly."""
        units = ("m" if slides else "rad" for slides in self.slides)
        header = [TIME, *(f"{name}_{unit}" for name, unit in zip(self.joint_names, units, strict=True))]
        rows = np.column_stack([self.time_s, self.q])
        return "\n".join([",".join(header), *(",".join(map(repr, row)) for row in rows.tolist())]) + "\n"

    def write(self, path: Path | str) -> None:
        """Write the CSV, whole or not at all."""
        write_text(path, self.to_csv())

    @classmethod
    def read(cls, path: Path | str, chain: SerialChain) -> "JointTable":
        """Read the columns of `chain`'s joints. Raises BadTable, naming line and column."""
        return cls.from_csv(read_text(path, BadTable, LARGEST_TABLE), chain, path)

    @classmethod
    def from_csv(cls, text: str, chain: SerialChain, source: object = "joint table") -> "JointTable":
        """The table in a CSV text; columns of other names are left out."""
        rows = [row for _, row in csv_rows(text, source, BadTable)]
        header = [cell.strip() for cell in rows[0]] if rows else []
        if TIME not in header:
            raise BadTable(source, f"its first line lacks the column {TIME}")
        picked = [(header.index(TIME), 1.0)]
        for name, slides in zip(chain.joint_names, chain.slides, strict=True):
            picked.append(_column(header, name, SCALES[bool(slides)], source))
        if len(rows) < 2:
            raise BadTable(source, "it has no rows")
        values = np.empty((len(rows) - 1, len(picked)))
        for i, row in enumerate(rows[1:]):
            if len(row) != len(header):
                raise BadTable(source, f"line {i + 2} has {len(row)} fields, the first line {len(header)}")
            for j, (column, scale) in enumerate(picked):
                values[i, j] = scale * _number(row[column], source, i + 2, header[column])
        time = values[:, 0]
        if not ((time >= 0).all() and (np.diff(time) > 0).all()):
            raise BadTable(source, f"line {_first_bad(time) + 1}: {TIME} must rise from 0 or later")
        return cls.of(chain, time, values[:, 1:])


def _column(header: Sequence[str], joint: str, scales: dict[str, float], source: object) -> tuple[int, float]:
    """Where a joint's column is, and the factor to SI."""
    for unit, scale in scales.items():
        if f"{joint}_{unit}" in header:
            return header.index(f"{joint}_{unit}"), scale
    wanted = " or ".join(f"{joint}_{unit}" for unit in scales)
    raise BadTable(source, f"its first line lacks {wanted}; it has {', '.join(header)}")


def _number(cell: str, source: object, line: int, column: str) -> float:
    value = number(cell)
    if value is None:
        raise BadTable(source, f"line {line}: {column} is {cell!r}, not a number")
    if np.isnan(value):
        raise BadTable(source, f"line {line}: {column} is {cell!r}, not finite")
    return value


def _first_bad(time_s: Float[Array, "n"]) -> int:
    """Row, counted from 1, of the first time that does not rise."""
    wrong = ~np.isfinite(time_s) | (time_s < 0)
    wrong[1:] |= ~(np.diff(time_s) > 0)
    return int(np.flatnonzero(wrong)[0]) + 1
