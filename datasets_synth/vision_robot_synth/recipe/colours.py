"""Names of colours in recipes."""

import re
from typing import Any

__all__ = ["COLOURS", "RGB", "colour_named"]

RGB = tuple[float, float, float]
"""Red, green, blue from 0 to 1."""

COLOURS: dict[str, RGB] = {
    "red": (0.82, 0.14, 0.10),
    "orange": (0.92, 0.45, 0.08),
    "yellow": (0.92, 0.80, 0.12),
    "green": (0.15, 0.55, 0.22),
    "cyan": (0.10, 0.62, 0.68),
    "blue": (0.12, 0.28, 0.72),
    "violet": (0.45, 0.20, 0.62),
    "magenta": (0.90, 0.12, 0.62),
    "brown": (0.42, 0.26, 0.14),
    "white": (0.92, 0.92, 0.90),
    "grey": (0.50, 0.50, 0.50),
    "black": (0.08, 0.08, 0.09),
    "wood": (0.72, 0.58, 0.42),
}


def colour_named(value: Any) -> RGB | None:
    """A name, "#rrggbb" or three numbers from 0 to 1 as a colour; None for anything else."""
    if isinstance(value, str):
        if re.fullmatch(r"#[0-9a-fA-F]{6}", value):
            red, green, blue = (int(value[i : i + 2], 16) / 255 for i in (1, 3, 5))
            return red, green, blue
        return COLOURS.get(value)
    if not isinstance(value, list | tuple) or len(value) != 3:
        return None
    good = all(isinstance(v, int | float) and not isinstance(v, bool) and 0 <= v <= 1 for v in value)
    return (float(value[0]), float(value[1]), float(value[2])) if good else None
