"""How sharp the edges at a corner should be, by the corners around it.

An edge that runs along the pixel rows shows its place and its blur in one mixed row of pixels: one
number for two unknowns. Blur changes slowly over a picture, so the other corners know it.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.saddle.light import smooth_surface
from vision_robot.calibrate.saddle.optimum import SHARPEST, Optimum
from vision_robot.calibrate.saddle.problem import GEOMETRY
from vision_robot.types import Array, Bool, Float

__all__ = ["SharpnessPrior", "sharpness_prior"]

LEAST_SCATTER = 0.02


@dataclass(frozen=True)
class SharpnessPrior:
    """Expected sharpness of the two edges [1/px] and how firmly, over the variance of the samples."""

    expected: Float[Array, "n 2"]
    precision: Float[Array, "n 2"]

    def take(self, some: Array) -> "SharpnessPrior":
        """The prior of some of the corners."""
        return SharpnessPrior(self.expected[some], self.precision[some])

    def terms(
        self, theta: Float[Array, "n p"]
    ) -> tuple[Float[Array, "n p p"], Float[Array, "n p"], Float[Array, "n"]]:
        """What the prior adds to the normal matrix, to the gradient's negative and to the cost."""
        n, p = theta.shape
        matrix, vector = np.zeros((n, p, p)), np.zeros((n, p))
        normals = theta[:, 2:GEOMETRY].reshape(n, 2, 2)
        size = np.linalg.norm(normals, axis=2).clip(1e-9)
        away = self.expected - size
        for e, block in ((0, slice(2, 4)), (1, slice(4, 6))):
            along = normals[:, e] / size[:, e, None]
            matrix[:, block, block] = self.precision[:, e, None, None] * along[:, :, None] * along[:, None, :]
            vector[:, block] = self.precision[:, e, None] * away[:, e, None] * along
        return matrix, vector, (self.precision * away**2).sum(axis=1)


def sharpness_prior(fit: Optimum, good: Bool[Array, "n"], pixels: Float[Array, "n 2"]) -> SharpnessPrior:
    """A smooth surface through the fits that are `good`, held as firmly as these follow it."""
    size = np.linalg.norm(fit.sharpness, axis=2)
    usual = np.median(size[good], axis=0)
    seen = np.where(good[:, None], size, usual)
    expected = smooth_surface(pixels, seen, np.ones_like(seen)).clip(0.5 * usual, 2 * usual)
    scatter = 1.48 * np.median(np.abs(seen - expected), axis=0) + LEAST_SCATTER * usual
    precision = np.median(fit.variance[good]) / scatter**2
    return SharpnessPrior(np.minimum(expected, SHARPEST), np.broadcast_to(precision, size.shape).copy())
