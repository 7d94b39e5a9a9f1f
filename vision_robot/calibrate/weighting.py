"""How far each corner is to be trusted: the detector's word, and what it cannot know.

A detector's sigma tells what noise and blur leave open. The curl of paper, a lens model too
simple, an edge that is not straight come on top and are the same for sharp and blurred
corners. So the variance of a residual is taken as ``scale^2 sigma^2 + floor^2``, and both
parts are found from the residuals by maximum likelihood (variance components; Searle,
Casella & McCulloch 1992, chapter 6).
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["UNDOUBTED", "Trust", "trust"]


@dataclass(frozen=True)
class Trust:
    """Standard deviation per axis [px] of a corner: ``hypot(scale * sigma_px, floor_px)``."""

    scale: float
    floor_px: float

    def sigma(self, sigma_px: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
        """What a corner of detector sigma `sigma_px` really has."""
        return np.hypot(self.scale * sigma_px, self.floor_px)


UNDOUBTED = Trust(1.0, 0.0)
"""The detector taken at its word."""


def trust(lengths_px: Float[Array, "n"], sigma_px: Float[Array, "n"]) -> Trust:
    """Scale and floor from residual lengths (both axes) and the detector's sigmas.

    Corners past the 99th percentile of what a first guess expects have no say, so that a
    few outliers do not raise the floor.
    """
    variance = sigma_px**2
    if np.ptp(variance) <= 1e-9 * variance.max():
        return Trust(float(np.median(lengths_px) / MEDIAN / sigma_px[0]), 0.0)
    squared = lengths_px**2 / 2
    keep = np.ones(len(squared), dtype=bool)
    best = Trust(1.0, 0.0)
    for _ in range(3):
        best = _most_likely(squared[keep], variance[keep])
        keep = lengths_px <= FAR * best.sigma(sigma_px)
    total = best.sigma(sigma_px)
    low, high = np.percentile(total, (5, 95))
    if high < ALIKE * low:
        return Trust(0.0, float(np.sqrt(np.mean(total**2))))
    return best


MEDIAN = 1.1774
"""Median length of a two-dimensional Gaussian vector of unit sigma."""

ALIKE = 1.3
"""Nine corners in ten closer to each other than this factor count alike: weights would gain less than two
percent of precision, and equal weights keep the plain least-squares optimum that other tools find."""

FAR = 3.5
"""Length in sigmas that a Gaussian vector exceeds once in 450 times."""


def _most_likely(squared: Float[Array, "n"], variance: Float[Array, "n"]) -> Trust:
    """Search the ratio floor^2 / scale^2; the scale then follows in closed form."""
    typical = np.median(variance)
    ratios = np.concatenate([[0.0], typical * np.geomspace(1e-3, 1e6, 91)])
    total = variance + ratios[:, None]
    scales = np.mean(squared / total, axis=1)
    # Two axes a corner: twice the log-likelihood is -2 sum log(scale^2 (v + ratio)) - const.
    cost = 2 * np.log(total).sum(axis=1) + 2 * len(squared) * np.log(np.maximum(scales, 1e-300))
    best = int(np.argmin(cost))
    return Trust(float(np.sqrt(scales[best])), float(np.sqrt(scales[best] * ratios[best])))
