"""Does the plane foretell where points are that it was not fitted to?"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.extrinsics.plane import PlaneFit, fit_plane
from vision_robot.geometry import SE3, KnownCamera
from vision_robot.types import Array, Float

__all__ = ["HeldOut", "held_out"]

FOLDS = 5
FEWEST = 20
"""With fewer points each fold would leave too few to fit."""


@dataclass(frozen=True)
class HeldOut:
    """Errors on the plane [m] of points that were left out of the fit, and their foretold covariance."""

    pixels: Float[Array, "n 2"]
    errors: Float[Array, "n 2"]
    covariance: Float[Array, "n 2 2"]

    @property
    def rms_m(self) -> float:
        """Root mean square error, both axes together."""
        return float(np.sqrt(np.mean(np.sum(self.errors**2, axis=1))))

    @property
    def foretold_m(self) -> float:
        """What the covariances say it should be."""
        return float(np.sqrt(np.mean(np.trace(self.covariance, axis1=1, axis2=2))))

    @property
    def ratio(self) -> float:
        """Error over foretold error, each point in its own units: 1 where the covariance is right."""
        white = np.einsum("ni,nij,nj->n", self.errors, np.linalg.inv(self.covariance), self.errors)
        return float(np.sqrt(np.mean(white) / 2))


def held_out(
    known: KnownCamera, fit: PlaneFit, board_points: Float[Array, "m 3"], station_from_board: SE3
) -> HeldOut | None:
    """Every fifth point of the first view left out in turn; None where there are too few points."""
    view, rest = fit.views[0], fit.views[1:]
    if len(view) < FEWEST:
        return None
    found = []
    for fold in range(FOLDS):
        out = np.arange(len(view)) % FOLDS == fold
        kept, left = _some(view, ~out), _some(view, out)
        again = fit_plane(known, [kept, *rest], board_points, station_from_board, robust=False)
        truth = station_from_board.apply(board_points[left.ids])
        # Points of a board that is not flat on the plane have heights of their own.
        for z_m in np.unique(truth[:, 2]):
            level = truth[:, 2] == z_m
            noise = left.sigma_px[level] / np.mean(view.sigma_px) * again.noise_px
            positions, covariance = again.plane.measure(left.pixels[level], noise, z_m=float(z_m))
            found.append((left.pixels[level], positions - truth[level, :2], covariance))
    pixels, errors, covariance = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return HeldOut(pixels, errors, covariance)


def _some(view: Corners, which: Array) -> Corners:
    return Corners(view.image, view.ids[which], view.pixels[which], view.sigma_px[which])
