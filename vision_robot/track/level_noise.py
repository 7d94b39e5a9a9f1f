"""Noise of each channel as a function of its grey level, found from what stands still."""

import numpy as np

from vision_robot.types import Array, Float, UInt8

__all__ = ["LevelNoise"]

CLASSES = 16
"""Classes of grey levels; noise of light and gamma change slowly over them."""

LARGEST = 64
"""Differences from here on are counted together."""

FORGET = 0.97
"""What is kept of the counts at each update: memory of some 30 updates."""

ENOUGH = 200.0
"""Samples of a class before its own noise is told apart from the rest's."""

LEAST = 0.3
"""Standard deviation of rounding to whole levels [levels]; noise below it cannot be told."""

NORMAL = 1.4826
"""Standard deviation of a normal distribution over its median absolute deviation."""


class LevelNoise:
    """Counts of absolute differences, by channel and class of level, that fade with time."""

    def __init__(self, channels: int):
        self._counts = np.zeros((channels, CLASSES, LARGEST))
        self._sigma: Array | None = None

    def update(self, difference: UInt8[Array, "k c"], level: UInt8[Array, "k c"]) -> None:
        """Absolute differences between frames and the background at pixels that show nothing else."""
        self._counts *= FORGET
        self._sigma = None
        for channel in range(len(self._counts)):
            key = (level[:, channel] >> 4).astype(np.intp) * LARGEST
            key += np.minimum(difference[:, channel], LARGEST - 1)
            self._counts[channel] += np.bincount(key, minlength=CLASSES * LARGEST).reshape(CLASSES, LARGEST)

    def sigma(self) -> Float[Array, "c classes"]:
        """Standard deviation of noise for each class of levels [levels], from the median difference."""
        if self._sigma is not None:
            return self._sigma
        own, overall = _sigma(self._counts), _sigma(self._counts.sum(axis=1, keepdims=True))
        weight = np.minimum(self._counts.sum(axis=2) / ENOUGH, 1.0)
        sigma = weight * own + (1 - weight) * overall
        self._sigma = sigma
        return sigma

    def table(self, factor: float, least: float) -> UInt8[Array, "1 256 c"]:
        """For cv2.LUT: from a background's levels to thresholds, `factor` times sigma, `least` at least."""
        sigma = self.sigma()
        middles = (np.arange(CLASSES) + 0.5) * (256 / CLASSES)
        levels = np.arange(256)
        thresholds = np.stack([np.interp(levels, middles, one) for one in sigma], axis=1) * factor
        return np.clip(np.ceil(np.maximum(thresholds, least)), 0, 255).astype(np.uint8)[None]


def _sigma(counts: Float[Array, "c k largest"]) -> Float[Array, "c k"]:
    """From histograms of whole absolute differences; difference d stands for d - 1/2 to d + 1/2."""
    total = counts.sum(axis=2)
    below = np.cumsum(counts, axis=2)
    middle = (below < total[..., None] / 2).sum(axis=2).clip(max=LARGEST - 1)[..., None]
    inside = np.take_along_axis(counts, middle, axis=2)[..., 0]
    before = np.take_along_axis(below, middle, axis=2)[..., 0] - inside
    share = (total / 2 - before) / np.maximum(inside, 1e-12)
    start, width = np.maximum(middle[..., 0] - 0.5, 0), np.where(middle[..., 0] > 0, 1.0, 0.5)
    return np.where(total > 0, np.maximum(NORMAL * (start + share * width), LEAST), LEAST)
