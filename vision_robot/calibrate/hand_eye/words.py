"""Numbers and names as sentences hold them."""

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["degrees", "direction", "millimetres", "short"]


def short(value: float, digits: int = 2) -> str:
    """A number to so many digits, never with an exponent: 149000, 0.023."""
    if not np.isfinite(value):
        return "an unknown number of"
    rounded = float(f"{value:.{digits}g}")
    decimals = max(digits - 1 - int(np.floor(np.log10(abs(rounded)))), 0) if rounded else 0
    return f"{rounded:.{min(decimals, 8)}f}"


def millimetres(metres: float, digits: int = 2) -> str:
    """A length in millimetres with its unit."""
    return f"{short(1e3 * metres, digits)} mm"


def degrees(radians: float, digits: int = 2) -> str:
    """An angle in degrees with its unit."""
    return f"{short(float(np.degrees(radians)), digits)} degrees"


def direction(axis: Float[Array, "3"], frame: str) -> str:
    """`the wrist's z axis`, or the direction's components where it is none of the three."""
    largest = int(np.argmax(np.abs(axis)))
    axis = axis * np.sign(axis[largest])
    if axis[largest] > np.cos(np.radians(8)):
        return f"the {frame}'s {'xyz'[largest]} axis"
    return f"({', '.join(f'{c:.2f}' for c in axis)}) of the {frame}"
