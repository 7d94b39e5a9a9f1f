"""Tables and intervals that the benchmarks print."""

import json
from collections.abc import Sequence

import numpy as np

from vision_robot.types import Array, Float


def markdown(columns: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A markdown table, its cells padded so that the source can be read too."""
    cells = [[str(cell) for cell in row] for row in (columns, *rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(columns))]
    lines = ["| " + " | ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) + " |" for row in cells]
    lines.insert(1, "|" + "|".join("-" * (w + 2) for w in widths) + "|")
    return "\n".join(lines)


def shown(schema: str, figures: object, table: str, *, as_json: bool) -> str:
    """One JSON object, or the table."""
    return json.dumps({"schema": schema, "figures": figures}, indent=1) if as_json else table


def mean_interval(values: Float[Array, "n"], *, seed: int = 0) -> tuple[float, float, float]:
    """Mean and its 95 % interval by bootstrap (percentiles of 4000 resamples)."""
    values = np.asarray(values, dtype=float)
    again = np.random.default_rng(seed).choice(values, (4000, len(values))).mean(axis=1)
    low, high = np.percentile(again, [2.5, 97.5])
    return float(values.mean()), float(low), float(high)


def wilson(hits: int, trials: int) -> tuple[float, float]:
    """95 % interval of a share (Wilson 1927)."""
    z, n = 1.959964, trials
    share = hits / n
    middle = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * np.sqrt(share * (1 - share) / n + z * z / (4 * n * n))
    return float(middle - half), float(middle + half)
