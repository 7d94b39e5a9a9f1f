"""Marks and words drawn into the pictures of a film."""

from dataclasses import dataclass
from typing import ClassVar

import cv2
import numpy as np

from vision_robot.types import Array, Float, Image

__all__ = ["GOAL", "SEEN", "TOOL", "Bar", "cross", "outline"]

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


@dataclass(frozen=True)
class Bar:
    """The line of words under a picture: what the arm does, how far off it is, and the time."""

    HEIGHT: ClassVar[int] = 44

    phase: str
    errors: str
    time_s: float

    def under(self, image: Image) -> Image:
        """The picture with the bar below, both sides even."""
        height, width = image.shape[:2]
        framed = np.full((height + self.HEIGHT + height % 2, width + width % 2, 3), 32, dtype=np.uint8)
        framed[:height, :width] = image
        scale = min(1.0, width / 640)
        self._write(framed, self.phase, (8, height + 18), 0.5 * scale, (255, 255, 255))
        self._write(framed, self.errors, (8, height + 36), 0.42 * scale, (210, 210, 210))
        self._write(framed, f"{self.time_s:.2f} s", (width - 70, height + 18), 0.45 * scale, (210, 210, 210))
        x = width - 250
        for name, colour in (("seen", SEEN), ("goal", GOAL), ("tool", TOOL)):
            self._write(framed, name, (x, height + 18), 0.42 * scale, colour)
            x += round(58 * scale)
        return framed

    @staticmethod
    def _write(
        image: Image, text: str, place: tuple[int, int], scale: float, colour: tuple[int, int, int]
    ) -> None:
        plain = text.encode("ascii", "replace").decode()  # the drawing font has no other letters
        cv2.putText(image, plain, place, cv2.FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv2.LINE_AA)
