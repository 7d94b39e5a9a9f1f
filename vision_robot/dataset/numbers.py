"""Text files of numbers, read with the line named where something is wrong."""

import re
from pathlib import Path

import numpy as np

from vision_robot.errors import BadTable
from vision_robot.reading import LARGEST_TABLE, number, read_text
from vision_robot.types import Array, Float

__all__ = ["read_numbers"]


def read_numbers(path: Path, least: int, most: int) -> tuple[Float[Array, "rows most"], list[int]]:
    """Rows of numbers between commas, tabs or blanks, and their line numbers.

    Columns that a row lacks are NaN. Raises BadTable for a row of fewer than `least` or more than
    `most`, and for anything that is no number.
    """
    rows, lines = [], []
    for at, line in enumerate(read_text(path, BadTable, LARGEST_TABLE).splitlines(), start=1):
        words = [word for word in re.split(r"[,;\s]+", line.strip()) if word]
        if not words:
            continue
        if not least <= len(words) <= most:
            raise BadTable(path, f"line {at} has {len(words)} numbers, not {least} to {most}")
        row = np.full(most, np.nan)
        for i, word in enumerate(words):
            value = number(word)
            if value is None:
                raise BadTable(path, f"line {at}: {word!r} is not a number")
            row[i] = value
        rows.append(row)
        lines.append(at)
    return np.array(rows).reshape(-1, most), lines
