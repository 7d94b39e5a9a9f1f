"""How far a camera stands from where it was calibrated, by looks at a label whose place the joints tell."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.geometry import SE3, Camera, WorkPlane
from vision_robot.geometry.se3 import skew
from vision_robot.pick.servo.stage import Glimpse
from vision_robot.pick.sighting import Sighting
from vision_robot.types import Array, Float

__all__ = ["EXACT_PX", "CameraShift", "camera_shift"]

MOST_STEPS, DONE = 12, 1e-10

EXACT_PX = 1e-3
"""Pixels better than this are taken for this: beside exact ones the prior would drown in rounding."""

ALONG_M = 0.02
"""Half the length of axis that is carried along when a thing is met again."""


@dataclass(frozen=True)
class CameraShift:
    """`now_from_then` of the camera, and its covariance as (w [rad], v [m]) in the camera's axes now."""

    then: WorkPlane
    now_from_then: SE3
    covariance: Float[Array, "6 6"]

    @property
    def plane(self) -> WorkPlane:
        """The plane before the camera where it stands now.

        The lens counts as exact: what it errs is nearly the same at the label and at the thing, and the shift
        has taken it in.
        """
        pose = self.now_from_then @ self.then.cam_from_station
        exact = WorkPlane.exact(self.then.camera, pose)
        # From a turn about the lens to one that leaves the station's origin: t + w x t + v = t + dt.
        onto = np.block([[np.eye(3), np.zeros((3, 3))], [-skew(pose.translation), np.eye(3)]])
        covariance = exact.covariance.copy()
        covariance[-6:, -6:] = onto @ self.covariance @ onto.T
        return replace(exact, covariance=(covariance + covariance.T) / 2)

    def met_again(self, first: Sighting) -> tuple[Sighting, float]:
        """What was seen first, by the same pixels through the camera where it stands now.

        Returned with it is the standard deviation [m] that the shift leaves in the worst direction.
        """
        along = ALONG_M * np.array([np.cos(first.yaw_rad), np.sin(first.yaw_rad)])
        ends = first.position_m + np.array([np.zeros(2), along, -along])
        pixels = self.then.pixels(ends, z_m=first.height_m)
        places, covariance = self.plane.measure(pixels, z_m=first.height_m)
        _, before = self.then.measure(pixels[:1], z_m=first.height_m)
        ahead = places[1] - places[2]
        again = replace(
            first,
            position_m=places[0],
            covariance_m2=first.covariance_m2 - before[0] + covariance[0],
            yaw_rad=float(np.arctan2(ahead[1], ahead[0])),
        )
        return again, float(np.sqrt(np.linalg.eigvalsh(covariance[0])[-1]))


def camera_shift(
    plane: WorkPlane, glimpses: Sequence[Glimpse], turn_sigma_rad: float, shift_sigma_m: float
) -> CameraShift:
    """The most probable shift by all `glimpses` together (maximum a posteriori by Gauss-Newton).

    Before any look it is none, give or take `turn_sigma_rad` and `shift_sigma_m` per axis. Errors of the arm
    and of the lens look like a shift too, and are taken for one: near the looks they are as good as one.
    Where the residuals are larger than the pixels' sigma explains, the covariance grows with them.
    """
    prior = np.diag([turn_sigma_rad**-2] * 3 + [shift_sigma_m**-2] * 3)
    shift, normal, cost = SE3.identity(), prior, 0.0
    if glimpses:
        points = plane.cam_from_station.apply(np.stack([one.label_in_station for one in glimpses]))
        pixels = np.stack([one.pixel for one in glimpses])
        weight = 1 / np.maximum([one.sigma_px for one in glimpses], EXACT_PX)[:, None]
        for _ in range(MOST_STEPS):
            residual, J = _seen(plane.camera, shift.apply(points), pixels, weight)
            gone = np.concatenate([shift.rotvec(), shift.translation])
            normal = prior + J.T @ J
            step = np.linalg.solve(normal, -(J.T @ residual + prior @ gone))
            turned = SE3.from_rotvec(step[:3], step[3:])
            shift, cost = turned @ shift, float(residual @ residual)
            if step @ normal @ step < DONE:
                break
    covariance = np.linalg.inv(normal)
    left = 2 * len(glimpses) - (6 - float(np.trace(prior @ covariance)))
    scale = max(1.0, cost / left) if left > 1 else 1.0
    return CameraShift(plane, shift, scale * covariance)


def _seen(
    camera: Camera, in_cam: Float[Array, "n 3"], pixels: Float[Array, "n 2"], weight: Float[Array, "n 1"]
) -> tuple[Float[Array, "2*n"], Float[Array, "2*n 6"]]:
    """Weighed residuals of the label's pixels, and their derivative in a turn and shift of the camera."""
    projected, in_point, _ = camera.project_jacobian(in_cam)
    J = np.concatenate([-in_point @ skew(in_cam), in_point], axis=2)
    # A step may lead outside the lens' field, where projections are NaN.
    residual = np.nan_to_num(weight * (projected - pixels))
    return residual.reshape(-1), np.nan_to_num(weight[:, :, None] * J).reshape(-1, 6)
