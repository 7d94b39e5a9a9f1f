"""Fields from a grid to the next coarser one, of half the pixels, and back."""

import cv2
import numpy as np

from vision_robot.flow.strips import Strip
from vision_robot.types import Array, Float

__all__ = ["coarse_rows", "coarse_shape", "grown", "grown_rows", "shrink"]


def coarse_shape(shape: tuple[int, int]) -> tuple[int, int]:
    """(height, width) of the coarser grid."""
    return (shape[0] + 1) // 2, (shape[1] + 1) // 2


def coarse_rows(strip: Strip) -> slice:
    """The rows of the coarser grid that a strip covers."""
    return slice(strip.first // 2, (strip.stop + 1) // 2)


def shrink(fine: Float[Array, "k r w"], coarse: Float[Array, "k rc wc"]) -> None:
    """Means of 2×2 pixels into `coarse`.

    What lies outside the picture counts as zero, so that a cell half outside pulls half as much.
    """
    odd = fine.shape[1] % 2, fine.shape[2] % 2
    for plane, out in zip(fine, coarse, strict=True):
        whole = (
            cv2.copyMakeBorder(plane, 0, odd[0], 0, odd[1], cv2.BORDER_CONSTANT, value=0)
            if any(odd)
            else plane
        )
        cv2.resize(whole, out.shape[::-1], dst=out, interpolation=cv2.INTER_AREA)


def grown(coarse: Float[Array, "k hc wc"], shape: tuple[int, int]) -> Float[Array, "k h w"]:
    """Linear interpolation onto the finer grid of that shape."""
    planes = grown_rows(coarse, shape, Strip(0, shape[0], 0, shape[0]))
    return np.stack(planes)


def grown_rows(
    coarse: Float[Array, "k hc wc"], shape: tuple[int, int], strip: Strip
) -> list[Float[Array, "r w"]]:
    """The rows of `grown` that a strip knows, one array a plane."""
    low = strip.low // 2 - (strip.low > 0)
    high = (strip.high + 1) // 2 + (strip.high < shape[0])
    size = (2 * coarse.shape[2], 2 * (high - low))
    rows = slice(strip.low - 2 * low, strip.high - 2 * low)
    return [
        cv2.resize(plane[low:high], size, interpolation=cv2.INTER_LINEAR)[rows, : shape[1]]
        for plane in coarse
    ]
