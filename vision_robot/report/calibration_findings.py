"""What a calibration's numbers say, worked out once for figures, tables and advice alike."""

import math
from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.judgement.advice import outlying_views
from vision_robot.calibrate.judgement.corner_positions import corners_in_cam
from vision_robot.calibrate.judgement.projection_uncertainty import (
    PictureError,
    expected_error,
    picture_grid,
    plane_sigma,
    projection_covariance_at,
    projection_sigma,
    worst_sigma,
)
from vision_robot.calibrate.judgement.whiteness import (
    NeighbourCorrelation,
    neighbour_correlation,
    normalised_residuals,
)
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.evaluate import ProjectionError, projection_difference, projection_error
from vision_robot.geometry import Camera
from vision_robot.types import Array, Bool, Float

__all__ = ["AgainstTruth", "Findings", "find"]


@dataclass(frozen=True)
class AgainstTruth:
    """A calibration beside the camera that made its pictures."""

    camera: Camera
    same_ray: ProjectionError
    rotation_fitted: ProjectionError
    grid: Float[Array, "k l 2"]
    map_same_ray: Float[Array, "k l 2"]
    map_rotation_fitted: Float[Array, "k l 2"]
    error_in_sigma: dict[str, float]
    chi_square: float
    probability: float
    """Chance of a larger chi-square if the stated covariance is right."""


@dataclass(frozen=True)
class Findings:
    """Numbers derived from a result; lengths in metres, angles in radians."""

    result: CalibrationResult
    stated_noise_factor: float
    """Scatter found over the scatter the detector stated."""
    stated: bool
    """Whether the detector stated different sigmas at all."""
    neighbours: NeighbourCorrelation
    largest_residual: float
    """In units of the noise of its corner."""
    tilt: Float[Array, "views"]
    distance: Float[Array, "views"]
    outlying: Bool[Array, "views"]
    covered: float
    """Part of the picture inside the outline of at least one board."""
    grid: Float[Array, "h w 2"]
    sigma_at_infinity: Float[Array, "h w"]
    sigma_at_boards: Float[Array, "h w"]
    sigma_on_plane_mm: Float[Array, "h w"]
    expected_error: PictureError
    truth: AgainstTruth | None

    @property
    def board_distance(self) -> float:
        """Median distance of the boards [m]."""
        return float(np.nanmedian(self.distance))


def find(result: CalibrationResult, truth: Camera | None = None) -> Findings:
    """Work out the findings; raises BadParameter where the truth has another picture size."""
    camera = result.camera
    weighted = np.concatenate(normalised_residuals(result))
    stated = np.concatenate([view.sigma_px for view in result.corners])
    dof = max(result.degrees_of_freedom, 1)
    factor = float(np.sqrt(np.sum(weighted**2) / dof))
    middles = [points.mean(axis=0) for points in corners_in_cam(result)]
    distance = np.linalg.norm(middles, axis=1)
    grid = picture_grid(camera)
    at_boards = projection_covariance_at(result, grid, float(np.nanmedian(distance)))
    return Findings(
        result=result,
        stated_noise_factor=factor,
        stated=bool(np.ptp(stated) > 0),
        neighbours=neighbour_correlation(result),
        largest_residual=float(np.abs(weighted).max() / factor) if factor else 0.0,
        tilt=np.arccos(np.clip(np.abs(result.cam_from_board.rotation[:, 2, 2]), 0, 1)),
        distance=distance,
        outlying=outlying_views(result),
        covered=_covered(result),
        grid=grid,
        sigma_at_infinity=projection_sigma(result, grid),
        sigma_at_boards=worst_sigma(at_boards),
        sigma_on_plane_mm=1000 * plane_sigma(result, grid, float(np.nanmedian(distance))),
        expected_error=expected_error(result),
        truth=None if truth is None else _against(result, truth),
    )


def _covered(result: CalibrationResult) -> float:
    import cv2

    shrink = max(result.camera.width, result.camera.height) / 400
    shape = np.ceil(np.array([result.camera.height, result.camera.width]) / shrink).astype(int)
    mask = np.zeros(shape, dtype=np.uint8)
    for view in result.corners:
        hull = cv2.convexHull((view.pixels / shrink).round().astype(np.int32))
        cv2.fillConvexPoly(mask, hull, 1)
    return float(mask.mean())


def _against(result: CalibrationResult, truth: Camera) -> AgainstTruth:
    camera = result.camera
    # Finer than the uncertainty's: a difference has rings of zeros.
    grid = picture_grid(truth, 128, 96)
    same_ray = projection_error(camera, truth)
    fitted = projection_error(camera, truth, fit_rotation=True)
    error_in_sigma, chi_square, probability = {}, np.nan, np.nan
    if camera.model == truth.model:
        error = camera.parameters - truth.parameters
        known = [i for i, name in enumerate(camera.parameter_names) if result.sigma.get(name, 0) > 0]
        error_in_sigma = {
            name: float(error[i] / result.sigma[name])
            for i, name in enumerate(camera.parameter_names)
            if i in known
        }
        chi_square, probability = _chi_square(
            error[known], result.covariance.intrinsics[np.ix_(known, known)]
        )
    return AgainstTruth(
        camera=truth,
        same_ray=same_ray,
        rotation_fitted=fitted,
        grid=grid,
        map_same_ray=projection_difference(camera, truth, grid),
        map_rotation_fitted=projection_difference(camera, truth, grid, rotation=fitted.rotation),
        error_in_sigma=error_in_sigma,
        chi_square=chi_square,
        probability=probability,
    )


def _chi_square(error: Float[Array, "k"], covariance: Float[Array, "k k"]) -> tuple[float, float]:
    """Joint error of all parameters in units of their covariance, and the chance of a larger one."""
    if not len(error):
        return 0.0, 1.0
    sigma = np.sqrt(np.diag(covariance))
    scaled = error / sigma
    chi_square = float(scaled @ np.linalg.solve(covariance / np.outer(sigma, sigma), scaled))
    return chi_square, _chi_square_tail(chi_square, len(error))


def _chi_square_tail(x: float, k: int) -> float:
    """Q(x; k) by Q(x; k) = Q(x; k-2) + (x/2)^(k/2-1) e^(-x/2) / Gamma(k/2) (Abramowitz & Stegun 26.4)."""
    if x <= 0:
        return 1.0
    odd = k % 2
    tail = math.erfc(math.sqrt(x / 2)) if odd else 0.0
    for degree in range(2 + odd, k + 1, 2):
        tail += math.exp((degree / 2 - 1) * math.log(x / 2) - x / 2 - math.lgamma(degree / 2))
    return min(tail, 1.0)
