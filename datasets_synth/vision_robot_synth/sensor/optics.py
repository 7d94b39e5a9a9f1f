"""Blur of the optics: what a point of light becomes on the sensor."""

from functools import lru_cache

import cv2
import numpy as np

from vision_robot.types import Array, Float, Image

__all__ = ["blurred", "disc_kernel", "gaussian_kernel"]

REACH = 3.5
"""Standard deviations after which a Gaussian is cut off."""
FINE = 16
"""Sub-pixels per pixel with which the rim of the disc is drawn."""


@lru_cache(maxsize=32)
def gaussian_kernel(sigma_px: float) -> Float[Array, "n"]:
    """A row of a Gaussian blur; the plane's kernel is its outer product with itself."""
    radius = max(1, int(np.ceil(REACH * sigma_px)))
    weights = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma_px) ** 2)
    return (weights / weights.sum()).astype(np.float32)


@lru_cache(maxsize=32)
def disc_kernel(radius_px: float) -> Float[Array, "n n"]:
    """A point out of focus: an even disc (the lens' round opening), its rim smooth to a sub-pixel."""
    radius = int(np.ceil(radius_px - 0.5)) if radius_px > 0.5 else 1
    fine = (np.arange((2 * radius + 1) * FINE) + 0.5) / FINE - radius - 0.5
    inside = np.hypot(fine[:, None], fine) <= radius_px
    side = 2 * radius + 1
    weights = inside.reshape(side, FINE, side, FINE).mean(axis=(1, 3))
    return (weights / weights.sum()).astype(np.float32)


def blurred(
    light: Image | Float[Array, "h w *c"], sigma_px: float, disc_px: float
) -> Image | Float[Array, "h w *c"]:
    """The picture behind the optics; the very same one where nothing blurs.

    The picture goes on beyond its border as it is at the border.
    """
    if disc_px > 0:
        light = cv2.filter2D(light, cv2.CV_32F, disc_kernel(disc_px), borderType=cv2.BORDER_REPLICATE)
    if sigma_px > 0:
        row = gaussian_kernel(sigma_px)
        light = cv2.sepFilter2D(light, cv2.CV_32F, row, row, borderType=cv2.BORDER_REPLICATE)
    return light
