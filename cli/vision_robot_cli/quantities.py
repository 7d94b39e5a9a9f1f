"""Quantities on the command line: ``25mm``, ``9x6``."""

import re

from vision_robot.errors import BadParameter

__all__ = ["length_m", "whole_pair"]

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


def whole_pair(text: str, option: str) -> tuple[int, int]:
    """Two positive whole numbers: ``9x6`` is 9 across and 6 down. Raises BadParameter naming `option`."""
    match = re.fullmatch(r"\s*(\d{1,6})\s*[x×,*]\s*(\d{1,6})\s*", text, re.IGNORECASE)
    pair = (int(match[1]), int(match[2])) if match else (0, 0)
    if min(pair) < 1:
        raise BadParameter(option, text, "two positive whole numbers, across x down, such as 9x6")
    return pair
