"""What the camera does to brightness between two pictures: noise, and exposure that changes."""

import cv2
import numpy as np

from vision_robot.types import Array, Float

__all__ = ["exposure_between", "noise_sigma"]

SAMPLES = 5000
TUNING = 2.0
"""Residuals beyond this many of their sigmas hardly count: they are moving objects."""

NOISE_MASK = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], dtype=np.float32) / 6
"""Immerkær (1996): blind to what is linear along either axis; keeps the variance of white noise."""


def noise_sigma(image: Array) -> float:
    """Standard deviation of a picture's white noise [grey levels], from the median of second differences."""
    rough = cv2.filter2D(np.asarray(image, dtype=np.float32), -1, NOISE_MASK)[1:-1, 1:-1]
    step = max(1, int(np.sqrt(rough.size / (4 * SAMPLES))))
    return float(1.4826 * np.median(np.abs(rough[::step, ::step])))


def exposure_between(first: Float[Array, "h w"], second: Float[Array, "h w"]) -> tuple[float, float]:
    """Gain and offset that make the second picture as bright as the first where most of it agrees.

    Regression through the means, moving objects left out by weights (Cauchy's) that fall with the residual.
    """
    step = max(1, int(np.ceil(np.sqrt(first.size / SAMPLES))))
    a, b = (picture[::step, ::step].astype(float).ravel() for picture in (first, second))
    weight = np.ones_like(a)
    gain, offset = 1.0, 0.0
    for _ in range(4):
        total = weight.sum()
        # Sums and no dot products, for which libraries start threads that wait for each other.
        mean_a, mean_b = float((weight * a).sum()) / total, float((weight * b).sum()) / total
        spread = float((weight * (b - mean_b) ** 2).sum())
        gain = float((weight * (a - mean_a) * (b - mean_b)).sum()) / spread if spread > 0 else 1.0
        gain = float(np.clip(gain, 0.5, 2))
        offset = mean_a - gain * mean_b
        off = a - gain * b - offset
        sigma = 1.4826 * float(np.median(np.abs(off))) + 0.1
        weight = 1 / (1 + (off / (TUNING * sigma)) ** 2)
    return gain, offset
