"""A work plane beside the truth."""

from dataclasses import dataclass

import numpy as np

from vision_robot.geometry import WorkPlane, rotation_log
from vision_robot.types import Array, Float

__all__ = ["PlaneError", "plane_error"]

GRID = (40, 25)
"""A thousand points, evenly over the picture."""


@dataclass(frozen=True)
class PlaneError:
    """How far a plane misses the truth, and what its covariance foretells."""

    camera_position_m: float
    """Error of the camera's position in {S}."""
    rotation: float
    """Angle between the two rotations [rad]."""
    chi_square: float
    """Squared error of the pose in units of its covariance: 6 on average where that is right."""
    points: int
    rms_m: float
    """Error of points of the plane, measured at the pixels where the true camera sees them; both axes."""
    foretold_m: float
    errors: Float[Array, "n 2"]
    covariance: Float[Array, "n 2 2"]
    positions: Float[Array, "n 2"]


def plane_error(plane: WorkPlane, truth: WorkPlane) -> PlaneError:
    """Compare pose and measured points; where a pixel sees no table in either, it is left out."""
    found, true = plane.cam_from_station, truth.cam_from_station
    step = np.concatenate(
        [rotation_log(true.rotation @ found.rotation.T), true.translation - found.translation]
    )
    sigma = np.sqrt(np.diag(plane.pose_covariance))
    scale = 1 / np.where(sigma > 0, sigma, 1.0)
    information = np.linalg.pinv(plane.pose_covariance * scale[:, None] * scale, rcond=1e-10)
    u = np.linspace(0, truth.camera.width - 1, GRID[0])
    v = np.linspace(0, truth.camera.height - 1, GRID[1])
    pixels = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    positions, _ = truth.measure(pixels)
    measured, covariance = plane.measure(pixels)
    both = np.isfinite(positions[:, 0]) & np.isfinite(measured[:, 0])
    errors = (measured - positions)[both]
    return PlaneError(
        camera_position_m=float(np.linalg.norm(found.inverse().translation - true.inverse().translation)),
        rotation=float(np.linalg.norm(step[:3])),
        chi_square=float((step * scale) @ information @ (step * scale)),
        points=int(both.sum()),
        rms_m=float(np.sqrt(np.mean(np.sum(errors**2, axis=1)))),
        foretold_m=float(np.sqrt(np.mean(np.trace(covariance[both], axis1=1, axis2=2)))),
        errors=errors,
        covariance=covariance[both],
        positions=positions[both],
    )
