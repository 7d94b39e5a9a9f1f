"""A camera on an arm, or beside it, and how well that is known."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry.camera import Camera
from vision_robot.geometry.known_camera import checked_covariance
from vision_robot.geometry.se3 import SE3, skew
from vision_robot.types import Array, Float

__all__ = ["MOUNTS", "HandEye"]

MOUNTS = {"eye-in-hand": ("wrist", "base"), "eye-to-hand": ("base", "wrist")}
"""Frame the camera is mounted on, and the one the board was mounted on, by set-up."""

STEPS = ("wx", "wy", "wz", "tx", "ty", "tz")


@dataclass(frozen=True)
class HandEye:
    """Where a camera sits, and the arm's noise.

    `mount_from_cam` is wrist_from_cam of an eye-in-hand, base_from_cam of an eye-to-hand.
    `covariance` (12, 12) is that of (w [rad], dt [m]) of mount_from_cam, then of far_from_board, where the
    calibration board stood. `arm_turn` [rad] and `arm_shift_m` are the arm's own noise per axis.
    """

    setup: str
    camera: Camera
    mount_from_cam: SE3
    far_from_board: SE3
    covariance: Float[Array, "12 12"]
    arm_turn: float = 0.0
    arm_shift_m: float = 0.0

    def __post_init__(self) -> None:
        if self.setup not in MOUNTS:
            raise BadParameter("set-up", self.setup, " or ".join(MOUNTS))
        object.__setattr__(self, "covariance", checked_covariance(self.covariance, 12, "hand-eye"))

    @property
    def mount_name(self) -> str:
        """`wrist_from_cam` or `base_from_cam`."""
        return f"{MOUNTS[self.setup][0]}_from_cam"

    @property
    def far_name(self) -> str:
        """`base_from_board` or `wrist_from_board`."""
        return f"{MOUNTS[self.setup][1]}_from_board"

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the rows of the covariance."""
        return tuple(f"{name}.{step}" for name in (self.mount_name, self.far_name) for step in STEPS)

    def base_from_cam(self, base_from_wrist: SE3 | None = None) -> SE3:
        """Where the camera is; an eye-in-hand needs to know where the wrist is."""
        if self.setup == "eye-to-hand":
            return self.mount_from_cam
        if base_from_wrist is None:
            raise BadParameter("base_from_wrist", None, "given, since this camera is carried by the wrist")
        return base_from_wrist @ self.mount_from_cam

    def base_covariance(
        self, point_in_cam: Float[Array, "3"], base_from_wrist: SE3 | None = None
    ) -> Float[Array, "3 3"]:
        """Covariance [m^2], in base axes, that calibration and arm give a camera-frame point in the base."""
        turned = self.mount_from_cam.rotation @ point_in_cam
        J = np.concatenate([-skew(turned), np.eye(3)], axis=1)
        spread = J @ self.covariance[:6, :6] @ J.T
        if self.setup == "eye-to-hand":
            return spread
        wrist = self.base_from_cam(base_from_wrist) @ self.mount_from_cam.inverse()
        lever = skew(wrist.rotation @ (turned + self.mount_from_cam.translation))
        arm = self.arm_shift_m**2 * np.eye(3) + self.arm_turn**2 * lever @ lever.T
        return wrist.rotation @ spread @ wrist.rotation.T + arm
