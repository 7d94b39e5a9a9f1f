"""The unknowns of a hand-eye calibration and how a step moves them."""

from dataclasses import dataclass, replace

import numpy as np

from vision_robot.calibrate.hand_eye.arm import ArmGeometry, GivenPoses
from vision_robot.calibrate.hand_eye.setup import Setup
from vision_robot.calibrate.state import State
from vision_robot.geometry import SE3, rotation_exp
from vision_robot.types import Array, Bool, Float

__all__ = ["HandEyeState", "nudged"]


@dataclass(frozen=True)
class HandEyeState:
    """What is fixed to the base, what the wrist carries, the pictures' poses, camera and arm.

    The *shared* unknowns are the camera's free parameters, (w, dt) of `base_from_fixed`, (w, dt) of
    `wrist_from_carried`, then the arm's own.
    """

    setup: Setup
    base_from_fixed: SE3
    wrist_from_carried: SE3
    pictures: State
    arm: GivenPoses | ArmGeometry

    @property
    def mount_from_cam(self) -> SE3:
        """Where the camera sits on its end of the arm."""
        return self.wrist_from_carried if self.setup.carries_camera else self.base_from_fixed

    @property
    def far_from_board(self) -> SE3:
        """Where the board sits on the other end."""
        return self.base_from_fixed if self.setup.carries_camera else self.wrist_from_carried

    @property
    def base_from_wrist(self) -> SE3:
        """Where the wrist was in each view, by the pictures."""
        carried = self.setup.fixed_from_carried(self.pictures.cam_from_board)
        return self.base_from_fixed @ carried @ self.wrist_from_carried.inverse()

    @property
    def predicted_cam_from_board(self) -> SE3:
        """Where the board is in each view, by the arm."""
        mount_from_far = self.setup.mount_from_far(self.arm.base_from_wrist)
        return self.mount_from_cam.inverse() @ mount_from_far @ self.far_from_board

    def moved(
        self, free: Bool[Array, "p"], shared: Float[Array, "s"], poses: Float[Array, "views 6"]
    ) -> "HandEyeState | None":
        """The state after a step; None if it is no camera."""
        p = int(free.sum())
        pictures = self.pictures.moved(free, shared[:p], poses)
        if pictures is None:
            return None
        return replace(
            self,
            base_from_fixed=nudged(self.base_from_fixed, shared[p : p + 6]),
            wrist_from_carried=nudged(self.wrist_from_carried, shared[p + 6 : p + 12]),
            pictures=pictures,
            arm=self.arm.moved(shared[p + 12 :]),
        )

    def keeping(self, views: Array) -> "HandEyeState":
        """Some of the views."""
        some = State(self.pictures.camera, self.pictures.cam_from_board[views], self.pictures.warp)
        return replace(self, pictures=some, arm=self.arm.keeping(views))


def nudged(pose: SE3, step: Float[Array, "6"]) -> SE3:
    """R <- Exp(w) R, t <- t + dt."""
    return SE3(rotation_exp(np.asarray(step[:3])) @ pose.rotation, pose.translation + step[3:])
