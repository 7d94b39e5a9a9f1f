"""How well a calibration knows where a point is imaged: its covariance carried into pixels.

Let b be the intrinsics with covariance C, found from noisy corners. Had the noise been
another, b would be b + db, and a point p fixed in the calibrated camera's frame would be
seen J(p) db elsewhere, with ``J = dq/db``. But the frame itself is only known through b:
boards placed by the changed camera stand elsewhere too, and so does anything placed by it
afterwards. Between the two frames lies a small rigid motion x = (w [rad], t [m]),
``p -> p + w x p + t``, which moves the pixel by ``P(p) x`` with ``P = dq/dp [-[p]_x  I]``.
It is the one under which both cameras agree best at reference points p_i:

    x = argmin sum_i |J_i db + P_i x|^2 = -(sum_i P_i^T P_i)^-1 (sum_i P_i^T J_i) db = -F db,

so that the pixel moves by ``(J - P F) db``, and its covariance is

    (J - P F) C (J - P F)^T.

This is the linear form of mrcal's projection uncertainty (D. Kogan, mrcal documentation,
"Projection uncertainty" and "Differencing", 2021), where x is called the implied
transformation; the corners' noise is taken as Gaussian and the lens model as right, so a
lens model too simple for the lens shows in the residuals, not here.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.judgement.corner_positions import corners_in_cam
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera, skew
from vision_robot.types import Array, Float

__all__ = [
    "PictureError",
    "expected_error",
    "picture_grid",
    "plane_sigma",
    "projection_covariance",
    "projection_covariance_at",
    "projection_sigma",
    "worst_sigma",
]

REFERENCE_GRID = (32, 24)
MOST_CORNERS = 4000
"""More corners than these do not change the fit of six numbers."""


def projection_sigma(
    result: CalibrationResult, pixels: Float[Array, "h w 2"] | None = None
) -> Float[Array, "h w"]:
    """One standard deviation, in its worst direction, of where a point at infinity is seen [px].

    `pixels` default to `picture_grid(result.camera)`. NaN where the lens model has no ray.
    """
    pixels = picture_grid(result.camera) if pixels is None else pixels
    return worst_sigma(projection_covariance(result, pixels))


def projection_covariance(
    result: CalibrationResult, pixels: Float[Array, "*batch 2"]
) -> Float[Array, "*batch 2 2"]:
    """Covariance [px^2] of where points at infinity are seen, which are now seen at `pixels`.

    Reference points: the directions of a regular grid over the whole picture, equally
    weighted; a translation does nothing at infinity, so x is a rotation. It is what
    `evaluate.projection_error(..., fit_rotation=True)` measures, predicted.
    """
    camera = result.camera
    reference = camera.unproject(picture_grid(camera, *REFERENCE_GRID).reshape(-1, 2))
    fit = _fit(camera, reference, moving=slice(0, 3))
    return _carried(result, camera.unproject(pixels), fit)


def projection_covariance_at(
    result: CalibrationResult, pixels: Float[Array, "*batch 2"], distance_m: float
) -> Float[Array, "*batch 2 2"]:
    """Covariance [px^2] of where points at a range of `distance_m` are seen, now seen at `pixels`.

    Reference points: the board's corners where the calibration saw them, so x is a rotation
    and a translation and the answer depends on the distance: least where the boards were.
    """
    if not (np.isfinite(distance_m) and distance_m > 0):
        raise BadParameter("distance", distance_m, "positive and finite, in metres")
    camera = result.camera
    fit = _fit(camera, _corners_in_cam(result), moving=slice(0, 6))
    return _carried(result, camera.unproject(pixels) * distance_m, fit)


def plane_sigma(
    result: CalibrationResult, pixels: Float[Array, "h w 2"], distance_m: float
) -> Float[Array, "h w"]:
    """One standard deviation, in its worst direction, of positions seen on a plane that faces the camera [m].

    The plane stands at z = `distance_m`; the camera is placed by the boards, as in
    `projection_covariance_at`. NaN for rays steeper than 70 degrees, where no such plane is of use.
    """
    if not (np.isfinite(distance_m) and distance_m > 0):
        raise BadParameter("distance", distance_m, "positive and finite, in metres")
    camera = result.camera
    rays = camera.unproject(pixels)
    with np.errstate(invalid="ignore", divide="ignore"):
        points = np.where(rays[..., 2:] > STEEPEST_COSINE, rays / rays[..., 2:] * distance_m, np.nan)
    flat = points.reshape(-1, 3)
    known = np.isfinite(flat).all(axis=1)
    fit = _fit(camera, _corners_in_cam(result), moving=slice(0, 6))
    in_pixels = _carried(result, flat[known], fit)
    per_metre = camera.project_jacobian(flat[known])[1][..., :2]
    on_plane = np.linalg.inv(per_metre)
    sigma = np.full(len(flat), np.nan)
    sigma[known] = worst_sigma(on_plane @ in_pixels @ on_plane.transpose(0, 2, 1))
    return sigma.reshape(points.shape[:-1])


STEEPEST_COSINE = float(np.cos(np.radians(70)))


def worst_sigma(covariance: Float[Array, "*batch 2 2"]) -> Float[Array, "*batch"]:
    """Standard deviation along the longest axis of each covariance."""
    a, b, c = covariance[..., 0, 0], covariance[..., 0, 1], covariance[..., 1, 1]
    return np.sqrt((a + c) / 2 + np.hypot((a - c) / 2, b))


def picture_grid(camera: Camera, columns: int = 64, rows: int = 48) -> Float[Array, "rows columns 2"]:
    """Pixels (u, v) spread evenly from the first to the last."""
    u, v = np.linspace(0, camera.width - 1, columns), np.linspace(0, camera.height - 1, rows)
    return np.stack(np.meshgrid(u, v), axis=-1)


@dataclass(frozen=True)
class PictureError:
    """What the projection error over the whole picture is expected to be, in px rms.

    `expected_px` is the root of its mean square; 95 of 100 calibrations as good as this one
    lie between `low_px` and `high_px`.
    """

    expected_px: float
    low_px: float
    high_px: float


def expected_error(result: CalibrationResult) -> PictureError:
    """Rms over the picture of the projection error at infinity, best rotation taken out, foretold.

    The mean square over the picture is the form ``db^T A db`` with A the mean of
    ``(J - P F)^T (J - P F)``; with db normal it is distributed as a sum of chi-squares of one
    degree, weighted by the eigenvalues of ``C^1/2 A C^1/2``. Its quantiles are drawn.
    """
    camera = result.camera
    rays = camera.unproject(picture_grid(camera, *REFERENCE_GRID).reshape(-1, 2))
    fit = _fit(camera, rays, moving=slice(0, 3))
    J, P = _jacobians(camera, rays[np.isfinite(rays).all(axis=1)])
    J = J - P[..., fit.moving] @ fit.from_intrinsics
    values, vectors = np.linalg.eigh(result.covariance.intrinsics)
    root = J @ (vectors * np.sqrt(np.maximum(values, 0)))
    weights = np.linalg.eigvalsh(np.einsum("nip,niq->pq", root, root) / len(root))
    squares = np.random.default_rng(0).chisquare(1, size=(20_000, len(weights))) @ np.maximum(weights, 0)
    low, high = np.sqrt(np.quantile(squares, [0.025, 0.975]))
    return PictureError(float(np.sqrt(max(weights.sum(), 0))), float(low), float(high))


@dataclass(frozen=True)
class _Fit:
    """F, and which of (w, t) it yields."""

    from_intrinsics: Float[Array, "k p"]
    moving: slice


def _fit(camera: Camera, points: Float[Array, "n 3"], *, moving: slice) -> _Fit:
    J, P = _jacobians(camera, points)
    known = np.isfinite(J).all(axis=(1, 2))
    J, P = J[known].reshape(-1, J.shape[-1]), P[known][..., moving].reshape(2 * known.sum(), -1)
    return _Fit(np.linalg.lstsq(P, J, rcond=None)[0], moving)


def _carried(result: CalibrationResult, points: Array, fit: _Fit) -> Float[Array, "*batch 2 2"]:
    J, P = _jacobians(result.camera, points.reshape(-1, 3))
    J = J - P[..., fit.moving] @ fit.from_intrinsics
    covariance = J @ result.covariance.intrinsics @ np.swapaxes(J, -1, -2)
    return covariance.reshape(*points.shape[:-1], 2, 2)


def _jacobians(camera: Camera, points: Float[Array, "n 3"]) -> tuple[Array, Array]:
    """dq/db (n, 2, p) and dq/dx (n, 2, 6)."""
    _, in_point, in_parameters = camera.project_jacobian(points)
    return in_parameters, np.concatenate([-in_point @ skew(points), in_point], axis=-1)


def _corners_in_cam(result: CalibrationResult) -> Float[Array, "n 3"]:
    every = max(1, result.corner_count // MOST_CORNERS)
    return np.concatenate(corners_in_cam(result, every=every))
