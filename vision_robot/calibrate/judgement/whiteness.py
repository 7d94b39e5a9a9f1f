"""Whether residuals are noise: neighbouring corners must not err together."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.judgement.corner_positions import corners_in_cam
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.geometry import skew
from vision_robot.types import Array, Float, Int

__all__ = ["NeighbourCorrelation", "neighbour_correlation", "neighbour_pairs", "normalised_residuals"]

MOST_VIEWS = 300
"""With more views every second, third, ... is asked: 0.01 of correlation is close enough."""


@dataclass(frozen=True)
class NeighbourCorrelation:
    """Correlation of the residuals of neighbouring corners in a view, in [-1, 1].

    `value` has the part taken out that the fit itself brings about: pure noise gives zero
    with one standard deviation `sigma`, over `pairs` pairs.
    """

    value: float
    sigma: float
    pairs: int

    @property
    def z(self) -> float:
        """How many standard deviations from what pure noise would give."""
        return self.value / self.sigma


def normalised_residuals(result: CalibrationResult) -> tuple[Float[Array, "_ 2"], ...]:
    """Each view's residuals in units of their corners' sigma, no unit."""
    pairs = zip(result.residuals, result.corners, strict=True)
    return tuple(residual / view.sigma_px[:, None] for residual, view in pairs)


def neighbour_correlation(result: CalibrationResult) -> NeighbourCorrelation:
    """Correlation of each corner's residual with that of the corner next to it in the picture.

        r = sum_pairs (e_i . e_j + s^2 tr H_ij) / (2 s^2 pairs),   s^2 = sum |e|^2 / (2 n - 6 views)

    A view's pose follows its noise, which leaves residuals with the covariance
    ``s^2 (I - H)``, ``H = J (J^T J)^-1 J^T`` and J the Jacobian in that pose; the trace
    brings the expectation under pure noise back to zero. (The few shared intrinsics do the
    same to a far smaller extent and are left out.) Distinct pairs of white noise are
    uncorrelated, so sigma = 1 / sqrt(2 pairs). Products are those of Moran's I (Moran 1950).
    """
    product, hat, pairs, squares, free = 0.0, 0.0, 0, 0.0, 0
    residuals, points = normalised_residuals(result), corners_in_cam(result)
    for i in range(0, len(residuals), 1 + len(residuals) // MOST_VIEWS):
        e = residuals[i]
        seen = result.corners[i].pixels
        first, second = neighbour_pairs(seen).T
        H = _pose_hat(result, i, points[i])
        product += float(np.sum(e[first] * e[second]))
        hat += float(np.trace(H[first, :, second], axis1=-2, axis2=-1).sum())
        squares += float(np.sum(e**2))
        pairs += len(first)
        free += 2 * len(e) - 6
    variance = squares / max(free, 1)
    if not pairs or variance == 0:
        return NeighbourCorrelation(0.0, np.inf, pairs)
    value = (product + variance * hat) / (2 * variance * pairs)
    return NeighbourCorrelation(float(value), float(1 / np.sqrt(2 * pairs)), pairs)


def neighbour_pairs(pixels: Float[Array, "n 2"]) -> Int[Array, "k 2"]:
    """Each point with the one nearest to it, a pair named once."""
    n = len(pixels)
    if n < 2:
        return np.zeros((0, 2), dtype=np.int64)
    distance = np.sum((pixels[:, None] - pixels[None]) ** 2, axis=-1)
    np.fill_diagonal(distance, np.inf)
    pairs = np.column_stack([np.arange(n), distance.argmin(axis=1)])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def _pose_hat(result: CalibrationResult, view: int, points: Float[Array, "n 3"]) -> Float[Array, "n 2 n 2"]:
    """Hat matrix of one view's pose, in weighted residuals."""
    corners, pose = result.corners[view], result.cam_from_board[view]
    _, in_point, _ = result.camera.project_jacobian(points)
    J = np.concatenate([-in_point @ skew(points - pose.translation), in_point], axis=-1)
    J = np.where(np.isfinite(J), J, 0.0) / corners.sigma_px[:, None, None]
    n = len(corners)
    Q = np.linalg.qr(J.reshape(2 * n, 6))[0]
    return (Q @ Q.T).reshape(n, 2, n, 2)
