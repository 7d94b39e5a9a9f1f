"""Brightness derivatives of a pair, or of five frames, in grey levels per pixel and frame."""

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.flow.strips import strips
from vision_robot.types import Array, Float

__all__ = ["Derivatives", "cube", "four_point", "prefiltered"]

SMOOTH_SIGMA = 1.5
"""Width of the spatio-temporal prefilter, in pixels and frames, of Barron, Fleet and Beauchemin."""


class Derivatives(NamedTuple):
    """Along u, along v and in time."""

    x: Float[Array, "h w"]
    y: Float[Array, "h w"]
    t: Float[Array, "h w"]


def cube(first: Array, second: Array) -> Derivatives:
    """Horn and Schunck's: each the mean of the four differences along the edges of a 2×2×2 cube of pixels.

    The cube of pixel (u, v) reaches to (u + 1, v + 1), so what is estimated belongs to the cube's middle.
    """
    first, second = _whole(first), _whole(second)
    out = np.empty((3, *first.shape), np.result_type(first.dtype, np.float32))
    slope = np.array([[-1, 1], [-1, 1]], dtype=np.float32) / 4
    mean = np.ones((2, 2), dtype=np.float32) / 4
    for strip in strips(first.shape, 1):
        a, b = (picture[strip.known].astype(out.dtype) for picture in (first, second))
        both, change = cv2.add(a, b), cv2.subtract(b, a)
        for plane, (source, kernel) in zip(
            out, ((both, slope), (both, slope.T), (change, mean)), strict=True
        ):
            plane[strip.rows] = _cube_filter(source, kernel)[strip.inner]
    return Derivatives(*out)


def four_point(first: Array, second: Array) -> Derivatives:
    """Central differences (−1, 8, 0, −8, 1)/12 of the pair's mean, and the pair's difference in time.

    Barron, Fleet and Beauchemin (1994), section 2.1, for two frames; exact for cubics.
    """
    first, second = _float(first), _float(second)
    mean = cv2.addWeighted(first, 0.5, second, 0.5, 0)
    return Derivatives(*_central(mean), cv2.subtract(second, first))


def prefiltered(frames: Sequence[Array], sigma: float = SMOOTH_SIGMA) -> Derivatives:
    """The modified Horn–Schunck of Barron, Fleet and Beauchemin: smooth in space and time, then four points.

    Args:
        frames: An odd number of consecutive frames, at least 5; the flow is that of the middle one.
        sigma: Standard deviation of the smoothing, in pixels and frames.
    """
    if len(frames) < 5 or len(frames) % 2 == 0:
        raise BadParameter("number of frames", len(frames), "odd and at least 5")
    middle = len(frames) // 2
    smooth = [cv2.GaussianBlur(_float(frame), (0, 0), sigma) for frame in frames]
    steps = np.arange(-middle, middle + 1)
    # Smoothing and differentiating in time are one set of weights; it keeps what steps by 1 a frame at 1.
    bell = np.exp(-(steps**2) / (2 * sigma**2))
    slope = steps * bell / (steps**2 * bell).sum()
    mean = sum(float(weight) * frame for weight, frame in zip(bell / bell.sum(), smooth, strict=True))
    change = sum(float(weight) * frame for weight, frame in zip(slope, smooth, strict=True))
    return Derivatives(*_central(np.asarray(mean)), np.asarray(change))


def _central(image: Float[Array, "h w"]) -> tuple[Float[Array, "h w"], Float[Array, "h w"]]:
    line = np.array([1, -8, 0, 8, -1], dtype=np.float32) / 12
    along_u, along_v = line[None, :], line[:, None]
    border = cv2.BORDER_REPLICATE
    return (
        cv2.filter2D(image, -1, along_u, borderType=border),
        cv2.filter2D(image, -1, along_v, borderType=border),
    )


def _cube_filter(image: Float[Array, "h w"], kernel: Float[Array, "2 2"]) -> Float[Array, "h w"]:
    kernel = np.ascontiguousarray(kernel)
    return cv2.filter2D(image, -1, kernel, anchor=(0, 0), borderType=cv2.BORDER_REPLICATE)


def _whole(image: Array) -> Array:
    image = np.asarray(image)
    if image.ndim != 2:
        raise BadParameter("shape of a frame", image.shape, "(height, width): turn colour into grey first")
    return image


def _float(image: Array) -> Float[Array, "h w"]:
    image = _whole(image)
    return image if image.dtype in (np.float32, np.float64) else image.astype(np.float32)
