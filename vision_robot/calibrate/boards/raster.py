"""Drawings as pictures whose grey values are exact areas."""

import numpy as np

from vision_robot.calibrate.boards.drawing import Disc, Drawing, Polygon, TextLine
from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float, UInt8

__all__ = ["MAX_PIXELS", "raster"]

MAX_PIXELS = 2**29
"""Pictures above this size are refused: they would need gigabytes."""

LINES_PER_PIXEL = 16


def raster(drawing: Drawing, pixels_per_metre: float, *, text: bool = True) -> UInt8[Array, "height width"]:
    """The drawing as a grey picture, white 255.

    The page's top-left corner lies at pixel (-0.5, -0.5), so a page position (x, y) [m] is
    seen at ``(x * pixels_per_metre - 0.5, y * pixels_per_metre - 0.5)``. Each sample is the white
    share of its pixel's area: exact for upright rectangles; for other shapes exact along
    rows and taken on 16 lines a pixel across them. `text=False` leaves the print out.
    Raises BadParameter for a scale that is not positive or makes more than `MAX_PIXELS`.
    """
    if not (np.isfinite(pixels_per_metre) and pixels_per_metre > 0):
        raise BadParameter("pixels per metre", pixels_per_metre, "positive")
    width = int(np.ceil(drawing.width * pixels_per_metre - 1e-6))
    height = int(np.ceil(drawing.height * pixels_per_metre - 1e-6))
    if not 0 < width * height <= MAX_PIXELS:
        raise BadParameter(
            "picture size", f"{width}x{height} px", f"at most {MAX_PIXELS} pixels: lower --dpi"
        )
    ink = np.zeros((height, width), dtype=np.float32)
    for shape in drawing.shapes:
        _paint(ink, shape, pixels_per_metre)
    grey = np.rint(255 * (1 - np.clip(ink, 0, 1))).astype(np.uint8)
    if text:
        for line in drawing.texts:
            _print(grey, line, pixels_per_metre)
    return grey


def _paint(ink: Float[Array, "height width"], shape: Polygon | Disc, scale: float) -> None:
    left, top, right, bottom = (edge * scale for edge in shape.bounds)
    height, width = ink.shape
    j0, j1 = max(int(np.floor(left)), 0), min(int(np.ceil(right)), width)
    i0, i1 = max(int(np.floor(top)), 0), min(int(np.ceil(bottom)), height)
    if j0 >= j1 or i0 >= i1:
        return
    if isinstance(shape, Polygon) and shape.is_rectangle:
        area = np.outer(_cover(top, bottom, i0, i1), _cover(left, right, j0, j1))
    else:
        y = i0 + (np.arange((i1 - i0) * LINES_PER_PIXEL) + 0.5) / LINES_PER_PIXEL
        x = shape.crossings(y / scale) * scale
        # The signed lengths left of each crossing add up to the length inside.
        columns = np.arange(j0, j1)
        inside = np.zeros((len(y), len(columns)))
        for k in range(x.shape[1]):
            reach = np.clip(x[:, k, None] - columns, 0, 1)
            inside += np.nan_to_num(reach) * (1 if k % 2 else -1)
        area = inside.reshape(i1 - i0, LINES_PER_PIXEL, -1).mean(axis=1)
    ink[i0:i1, j0:j1] += area if shape.black else -area


def _cover(low: float, high: float, first: int, end: int) -> Float[Array, "n"]:
    """Share of each unit cell [k, k + 1] that lies between low and high."""
    cells = np.arange(first, end)
    return np.clip(np.minimum(high, cells + 1) - np.maximum(low, cells), 0, 1)


def _print(grey: UInt8[Array, "height width"], line: TextLine, scale: float) -> None:
    import cv2

    font, capital_px = cv2.FONT_HERSHEY_SIMPLEX, 22.0  # height of a capital at scale 1
    size = line.height * scale / capital_px
    if size * capital_px < 4:
        return  # too small to be read: leave it out rather than smear it
    at = (round(line.left * scale - 0.5), round(line.base * scale - 0.5))
    thickness = max(1, round(2 * size))
    cv2.putText(grey, line.text, at, font, size, 0, thickness, cv2.LINE_AA)
