"""What makes the error: the arm or the camera, in millimetres, now and at each later look."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.result import HandEyeResult
from vision_robot.geometry import skew
from vision_robot.types import Array, Float

__all__ = ["HandEyeBudget", "hand_eye_budget", "working_point"]

DOMINATES = 1.5
"""Times one cause must exceed the other to be called the one that matters."""


@dataclass(frozen=True)
class HandEyeBudget:
    """Root mean square errors [m], all axes together.

    `mount` splits where the camera sits by cause. `look` is one look at a point `distance_m` before the
    camera and its place in the base: the arm's pose at that moment, this calibration, one corner's noise.
    """

    mount: dict[str, float]
    look: dict[str, float]
    distance_m: float

    @property
    def arm_m(self) -> float:
        """The arm's part in where the camera sits."""
        return float(np.hypot(self.mount["arm's turns"], self.mount["arm's shifts"]))

    @property
    def corners_m(self) -> float:
        """The corners' part."""
        return self.mount["corners"]

    @property
    def dominant(self) -> str:
        """`arm`, `camera`, or `both` where neither exceeds the other by half."""
        if self.arm_m > DOMINATES * self.corners_m:
            return "arm"
        return "camera" if self.corners_m > DOMINATES * self.arm_m else "both"


def hand_eye_budget(result: HandEyeResult) -> HandEyeBudget:
    """Split the error by cause."""
    known = result.covariance
    mount = {name: float(np.sqrt(max(np.trace(part[3:6, 3:6]), 0.0))) for name, part in known.parts.items()}
    point = working_point(result)
    arm = point_jacobian(result, point)
    spread = float(np.trace(arm @ known.mount_from_cam @ arm.T))
    noise = result.noise.noise
    focal = np.sqrt(result.camera.fx * result.camera.fy)
    distance = float(np.linalg.norm(point))
    look = {
        "hand-eye": float(np.sqrt(max(spread, 0.0))),
        "one corner": float(np.sqrt(2) * result.noise_px * distance / focal),
    }
    if result.setup.carries_camera:
        lever = float(np.linalg.norm(result.mount_from_cam.apply(point[None])[0]))
        look["arm at that moment"] = float(np.sqrt(3 * noise.shift_m**2 + 2 * (noise.turn * lever) ** 2))
    return HandEyeBudget(mount, look, distance)


def working_point(result: HandEyeResult) -> Float[Array, "3"]:
    """A point on the optical axis at the board's median distance, in the camera frame [m]."""
    middle = result.problem.pictures.seen.points.mean(axis=2)
    boards = result.cam_from_board.apply(middle[:, None])[:, 0]
    return np.array([0.0, 0.0, float(np.median(np.linalg.norm(boards, axis=1)))])


def point_jacobian(result: HandEyeResult, point: Float[Array, "3"]) -> Float[Array, "3 6"]:
    """How a camera-frame point moves in the mount frame with (w, dt) of mount_from_cam."""
    turned = result.mount_from_cam.rotation @ point
    return np.concatenate([-skew(turned), np.eye(3)], axis=1)
