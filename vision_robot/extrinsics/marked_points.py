"""Points marked on the table, in a CSV: ``u_px,v_px,x_mm,y_mm`` and, if it is known, ``sigma_px``."""

from pathlib import Path

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.errors import BadTable
from vision_robot.reading import csv_rows, number, read_text
from vision_robot.types import Array, Float

__all__ = ["read_marked_points", "read_table"]


def read_marked_points(path: Path | str) -> tuple[Corners, Float[Array, "n 3"]]:
    """What was seen, and where on the plane [m]; raises BadTable, naming line and column."""
    table = read_table(path, ("u_px", "v_px", "x_mm", "y_mm"), optional=("sigma_px",))
    n = len(table["u_px"])
    positions = np.stack([table["x_mm"], table["y_mm"], np.zeros(n)], axis=1) / 1000
    if len(np.unique(positions, axis=0)) < n:
        raise BadTable(path, "two of its points have the same x_mm and y_mm")
    sigma = table.get("sigma_px", np.ones(n))
    if n and sigma.min() <= 0:
        raise BadTable(path, f"line {int(np.argmin(sigma)) + 2}: sigma_px must be positive")
    pixels = np.stack([table["u_px"], table["v_px"]], axis=1)
    return Corners(Path(path).name, np.arange(n), pixels, sigma), positions


def read_table(
    path: Path | str, columns: tuple[str, ...], *, optional: tuple[str, ...] = ()
) -> dict[str, Float[Array, "n"]]:
    """Columns of finite numbers from a CSV with a heading; others are ignored."""
    listed = csv_rows(read_text(path, BadTable), path, BadTable)
    rows = [row for _, row in listed if any(cell.strip() for cell in row)]
    header = [name.strip() for name in rows[0]] if rows else []
    missing = [name for name in columns if name not in header]
    if missing:
        raise BadTable(path, f"its first line lacks {', '.join(missing)}: {','.join(columns)} expected there")
    wanted = [name for name in (*columns, *optional) if name in header]
    numbers = np.zeros((len(rows) - 1, len(wanted)))
    for i, row in enumerate(rows[1:]):
        if len(row) != len(header):
            raise BadTable(path, f"line {i + 2} has {len(row)} fields, the first line {len(header)}")
        for j, name in enumerate(wanted):
            numbers[i, j] = _number(path, i + 2, name, row[header.index(name)])
    return {name: numbers[:, j] for j, name in enumerate(wanted)}


def _number(path: Path | str, line: int, column: str, cell: str) -> float:
    value = number(cell)
    if value is None or np.isnan(value):
        raise BadTable(path, f"line {line}: {column} is {cell.strip()!r}, not a finite number")
    return value
