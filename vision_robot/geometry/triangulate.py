"""Points in space from the pixels of several cameras, with their covariance."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry.camera_rig import CameraRig
from vision_robot.geometry.se3 import skew
from vision_robot.types import Array, Float, Int

__all__ = ["Triangulated", "triangulate"]

ITERATIONS = 20


@dataclass(frozen=True)
class Triangulated:
    """Points in the rig's frame; NaN where fewer than two cameras see one, or it lies behind one of them.

    `residuals` (n, cameras, 2) are projected minus seen [px], NaN where a camera did not see the point.
    """

    points: Float[Array, "n 3"]
    covariance: Float[Array, "n 3 3"]
    residuals: Float[Array, "n k 2"]
    cameras: Int[Array, "n"]
    """How many cameras each point was seen by."""

    @property
    def sigma(self) -> Float[Array, "n 3"]:
        """One standard deviation along the rig's axes [m]."""
        return np.sqrt(np.diagonal(self.covariance, axis1=1, axis2=2))

    @property
    def rms_px(self) -> Float[Array, "n"]:
        """Root mean square residual of each point, per sighting, both axes together."""
        squared = np.sum(self.residuals**2, axis=2)
        seen = np.isfinite(squared)
        return np.sqrt(np.where(seen, squared, 0).sum(axis=1) / np.maximum(seen.sum(axis=1), 1))


def triangulate(
    rig: CameraRig, pixels: Float[Array, "n k 2"], sigma_px: float | Float[Array, "n k"] = 1.0
) -> Triangulated:
    """The points that explain pixels best: rays met in the middle, then least squares in the pictures.

    `pixels` are NaN where a camera did not see a point; `sigma_px` is their standard deviation per axis.
    The covariance holds the pixels' noise and the rig's own uncertainty: at the minimum
    ``dX = -(sum A^T A)^-1 sum A^T (B db - dpixel)``, A the derivative in the point and B in camera and pose.
    """
    pixels = np.asarray(pixels, dtype=float)
    n, k = pixels.shape[:2]
    if k != len(rig):
        raise BadParameter("pixels of so many cameras", k, f"{len(rig)}, the rig's")
    sigma = np.broadcast_to(np.asarray(sigma_px, dtype=float), (n, k))
    if not (sigma > 0).all():
        raise BadParameter("sigma_px", float(sigma.min()), "positive")
    points, seen = _midpoints(rig, pixels)
    for _ in range(ITERATIONS):
        A, _, residual = _linearised(rig, points, pixels, seen, sigma)
        step = -_solve(A, residual[..., None])[..., 0]
        points = points + step
        if not np.nanmax(np.abs(step), initial=0.0) > 1e-12 * np.nanmax(np.abs(points), initial=1.0):
            break
    A, B, residual = _linearised(rig, points, pixels, seen, sigma)
    # Rows without a sighting are zero; each point's own inverse carries noise and the rig's error.
    normal = _inverse(A.transpose(0, 2, 1) @ A)
    follow = normal @ A.transpose(0, 2, 1) @ B
    covariance = normal + follow @ rig.covariance @ follow.transpose(0, 2, 1)
    residuals = np.where(seen[..., None], residual.reshape(n, k, 2) * sigma[..., None], np.nan)
    lost = ~np.isfinite(points[:, 0])
    covariance[lost] = residuals[lost] = np.nan
    return Triangulated(points, covariance, residuals, seen.sum(axis=1))


def _midpoints(rig: CameraRig, pixels: Array) -> tuple[Float[Array, "n 3"], Array]:
    """The point nearest to all rays, and which camera sees which point."""
    n, k = pixels.shape[:2]
    rig_from_cam = rig.cam_from_rig.inverse()
    normal, rhs, seen = np.zeros((n, 3, 3)), np.zeros((n, 3)), np.zeros((n, k), dtype=bool)
    for i, camera in enumerate(rig.cameras):
        rays = camera.unproject(pixels[:, i]) @ rig_from_cam.rotation[i].T
        seen[:, i] = np.isfinite(rays[:, 0])
        across = np.eye(3) - rays[:, :, None] * rays[:, None, :]
        across[~seen[:, i]] = 0
        normal += across
        rhs += across @ rig_from_cam.translation[i]
    points = (_inverse(normal) @ rhs[..., None])[..., 0]
    points[seen.sum(axis=1) < 2] = np.nan
    return points, seen


def _linearised(
    rig: CameraRig, points: Array, pixels: Array, seen: Array, sigma: Array
) -> tuple[Float[Array, "n rows 3"], Float[Array, "n rows q"], Float[Array, "n rows"]]:
    """Weighted derivatives in the points and in the rig's parameters, and residuals; zero where unseen."""
    n, k = seen.shape
    A, B = np.zeros((n, k, 2, 3)), np.zeros((n, k, 2, len(rig.covariance)))
    residual = np.zeros((n, k, 2))
    for i, camera in enumerate(rig.cameras):
        pose = rig.cam_from_rig[i]
        turned = points @ pose.rotation.T
        projected, in_cam, in_camera = camera.project_jacobian(turned + pose.translation)
        weight = 1 / sigma[:, i, None, None]
        A[:, i] = in_cam @ pose.rotation * weight
        in_pose = np.concatenate([-in_cam @ skew(turned), in_cam], axis=2)
        B[:, i, :, rig.rows(i)] = np.concatenate([in_camera, in_pose], axis=2) * weight
        residual[:, i] = (projected - pixels[:, i]) * weight[..., 0]
    for array in (A, B, residual):
        array[~seen] = 0
    return A.reshape(n, 2 * k, 3), B.reshape(n, 2 * k, -1), residual.reshape(n, 2 * k)


def _solve(A: Array, residual: Array) -> Array:
    transpose = A.transpose(0, 2, 1)
    return _inverse(transpose @ A) @ (transpose @ residual)


def _inverse(matrices: Float[Array, "n 3 3"]) -> Float[Array, "n 3 3"]:
    """Inverses; NaN for a singular one or one that is not finite."""
    scale = 1 / np.sqrt(np.maximum(np.diagonal(matrices, axis1=1, axis2=2), 1e-300))
    scaled = matrices * scale[:, :, None] * scale[:, None, :]
    index = np.flatnonzero(np.isfinite(scaled).all(axis=(1, 2)))
    good = index[np.linalg.det(scaled[index]) > 1e-14]
    inverse = np.full_like(matrices, np.nan)
    inverse[good] = np.linalg.inv(scaled[good]) * scale[good, :, None] * scale[good, None, :]
    return inverse
