"""Quantities on the command line: ``25mm``, ``9x6``."""

import re

from vision_robot.errors import BadParameter

__all__ = ["length_m", "offset_m", "offset_pair_m", "quantity", "whole_pair"]

METRES = {"um": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254}


def length_m(text: str, option: str) -> float:
    """A positive length with its unit, in metres.

    A bare number is refused: 25 and 0.025 are both in use for the same board, and a scale wrong
    by 1000 would show nowhere in the camera. Raises BadParameter naming `option`.
    """
    match = re.fullmatch(r"\s*([-+]?[0-9.]+(?:e[-+]?\d+)?)\s*([a-zµ\"]+)\s*", text, re.IGNORECASE)
    allowed = "a positive length with its unit, such as 25mm, 2.5cm, 0.025m or 1in"
    if not match:
        raise BadParameter(option, text, allowed)
    unit = match[2].lower().replace("µ", "u").replace('"', "in")
    try:
        length = float(match[1]) * METRES[unit]
    except (KeyError, ValueError):
        raise BadParameter(option, text, allowed) from None
    if not 0 < length < 1e3:
        raise BadParameter(option, text, allowed)
    # Ten digits: 25 mm is 0.025 m, not 0.025000000000000001.
    return float(f"{length:.10g}")


UNITS = {
    "rad": {"rad": 1.0, "mrad": 1e-3, "deg": 0.017453292519943295, "°": 0.017453292519943295},
    "m": METRES,
    "s": {"s": 1.0, "ms": 1e-3},
    "px": {"px": 1.0, "": 1.0},
    "levels": {"levels": 1.0, "": 1.0},
    "": {"": 1.0, "%": 0.01},
}
"""SI unit (or share, or levels) -> what may be typed and what it is worth."""


def quantity(text: str, unit: str, option: str) -> float:
    """A number with a unit of the kind of `unit`, in that unit: ``1deg`` in rad. Raises BadParameter."""
    match = re.fullmatch(r"\s*([-+]?[0-9.]+(?:e[-+]?\d+)?)\s*([a-zµ%°]*)\s*", text, re.IGNORECASE)
    known = UNITS[unit]
    worth = known.get(match[2].replace("µ", "u")) if match else None
    try:
        return float(match[1]) * worth  # type: ignore[index,operator]
    except (TypeError, ValueError):
        units = ", ".join(name or "no unit" for name in known)
        raise BadParameter(option, text, f"a number with its unit ({units})") from None


def whole_pair(text: str, option: str) -> tuple[int, int]:
    """Two positive whole numbers: ``9x6`` is 9 across and 6 down. Raises BadParameter naming `option`."""
    match = re.fullmatch(r"\s*(\d{1,6})\s*[x×,*]\s*(\d{1,6})\s*", text, re.IGNORECASE)
    pair = (int(match[1]), int(match[2])) if match else (0, 0)
    if min(pair) < 1:
        raise BadParameter(option, text, "two positive whole numbers, across x down, such as 9x6")
    return pair


def offset_m(text: str, option: str) -> float:
    """A length with its unit that may be zero or negative, in metres; a bare 0 needs no unit."""
    plain = text.strip()
    if plain in ("0", "+0", "-0"):
        return 0.0
    sign = -1.0 if plain.startswith("-") else 1.0
    number = re.match(r"[0-9.]+", plain.lstrip("+-"))
    if number and not any(digit in "123456789" for digit in number[0]):
        length_m(f"1{plain.lstrip('+-')[number.end() :]}", option)  # a zero still needs a unit that exists
        return 0.0
    try:
        return sign * length_m(plain.lstrip("+-") if plain[:1] in "+-" else plain, option)
    except BadParameter:
        raise BadParameter(option, text, "a length with its unit, such as 120mm, -35mm or 0") from None


def offset_pair_m(text: str, option: str) -> tuple[float, float]:
    """Two such lengths, ``120mm,-35mm``. Raises BadParameter naming `option`."""
    words = text.split(",")
    if len(words) != 2:
        raise BadParameter(option, text, "two lengths with their units, such as 120mm,-35mm")
    return offset_m(words[0], option), offset_m(words[1], option)
