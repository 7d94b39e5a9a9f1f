"""Text files of numbers, read with the line named where something is wrong."""

import re
from pathlib import Path

import numpy as np

from vision_robot.errors import BadTable
from vision_robot.types import Array, Float

__all__ = ["read_numbers", "read_words"]


def read_words(path: Path) -> str:
    """The text of a file. Raises BadTable where there is none."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise BadTable(path, getattr(error, "strerror", None) or "it is not text") from error


def read_numbers(path: Path, least: int, most: int) -> tuple[Float[Array, "rows most"], list[int]]:
    """Rows of numbers between commas, tabs or blanks, and their line numbers.

    Columns that a row lacks are NaN. Raises BadTable for a row of fewer than `least` or more than
    `most`, and for anything that is no number.
    """
    rows, lines = [], []
    for number, line in enumerate(read_words(path).splitlines(), start=1):
        words = [word for word in re.split(r"[,;\s]+", line.strip()) if word]
        if not words:
            continue
        if not least <= len(words) <= most:
            raise BadTable(path, f"line {number} has {len(words)} numbers, not {least} to {most}")
        row = np.full(most, np.nan)
        for i, word in enumerate(words):
            try:
                row[i] = float(word)
            except ValueError:
                raise BadTable(path, f"line {number}: {word!r} is not a number") from None
        rows.append(row)
        lines.append(number)
    return np.array(rows).reshape(-1, most), lines
