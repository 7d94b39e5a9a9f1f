"""Marks and words drawn into the pictures of a film."""

from collections.abc import Sequence

import cv2
import numpy as np

from vision_robot.types import Array, Float, Image

__all__ = ["GOAL", "SEEN", "TOOL", "WIDTH", "beside", "cross", "outline"]

SEEN, GOAL, TOOL = (0, 140, 255), (235, 140, 40), (70, 220, 70)
"""Blue-green-red: where the thing is believed, where it is to go, where the tool is believed."""

SUB = 3
"""Fractional bits with which marks are placed."""


def outline(image: Image, pixels: Float[Array, "n 2"], colour: tuple[int, int, int]) -> None:
    """A closed line through pixels; nothing where one of them is outside the lens."""
    if np.isfinite(pixels).all():
        cv2.polylines(image, [_fixed(pixels)], True, colour, 1, cv2.LINE_AA, SUB)


def cross(
    image: Image,
    pixel: Float[Array, "2"],
    colour: tuple[int, int, int],
    *,
    turned: bool = False,
    arm: float = 6.0,
) -> None:
    """A cross of two strokes, upright or turned by an eighth."""
    if not np.isfinite(pixel).all():
        return
    strokes = np.array([[1.0, 0.0], [0.0, 1.0]]) if not turned else np.array([[0.7, 0.7], [0.7, -0.7]])
    for stroke in strokes:
        line = _fixed(np.stack([pixel - arm * stroke, pixel + arm * stroke]))
        cv2.polylines(image, [line], False, (30, 30, 30), 3, cv2.LINE_AA, SUB)
        cv2.polylines(image, [line], False, colour, 1, cv2.LINE_AA, SUB)


def _fixed(pixels: Float[Array, "n 2"]) -> Array:
    return np.rint(np.clip(pixels, -4000, 4000) * (1 << SUB)).astype(np.int32)[:, None]


WIDTH = 240
"""Of the column beside the picture [px]."""

INK, SOFT, GROUND = (255, 255, 255), (200, 200, 200), (32, 32, 32)
LINE_PX = 21
MARGIN_PX = 10


def beside(image: Image, inset: Image | None, phase: str, lines: Sequence[str], time_s: float) -> Image:
    """The picture with a column at its right: a view from the side, what is done, how far off, and the time.

    Both sides come out even, as some codecs want it.
    """
    height, width = image.shape[:2]
    framed = np.full((height + height % 2, width + width % 2 + WIDTH, 3), GROUND, dtype=np.uint8)
    framed[:height, :width] = image
    x, y = width + width % 2, 0
    if inset is not None:
        framed[: inset.shape[0], x : x + inset.shape[1]] = inset[:height, :WIDTH]
        y = inset.shape[0]
    x += MARGIN_PX
    y += 8 + LINE_PX
    _write(framed, phase, (x, y), 0.55, INK)
    _write(framed, f"{time_s:.2f} s", (framed.shape[1] - 66, y), 0.45, SOFT)
    for line in lines:
        y += LINE_PX
        _write(framed, line, (x, y), 0.43, SOFT)
    y = height - MARGIN_PX
    for name, colour in (("seen", SEEN), ("goal", GOAL), ("tool", TOOL)):
        _write(framed, name, (x, y), 0.45, colour)
        x += 58
    return framed


def _write(
    image: Image, text: str, place: tuple[int, int], scale: float, colour: tuple[int, int, int]
) -> None:
    plain = text.encode("ascii", "replace").decode()  # the drawing font has no other letters
    cv2.putText(image, plain, place, cv2.FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv2.LINE_AA)
