"""What a hand-eye calibration returns: never a transform without its uncertainty."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.hand_eye.arm import ArmGeometry
from vision_robot.calibrate.hand_eye.arm_noise import NoiseEstimate
from vision_robot.calibrate.hand_eye.arm_residuals import arm_residuals
from vision_robot.calibrate.hand_eye.covariance import HandEyeCovariance
from vision_robot.calibrate.hand_eye.degeneracy import Motion
from vision_robot.calibrate.hand_eye.problem import HandEyeProblem
from vision_robot.calibrate.hand_eye.reduced import Reduced
from vision_robot.calibrate.hand_eye.setup import Setup
from vision_robot.calibrate.hand_eye.state import HandEyeState
from vision_robot.calibrate.normal_equations import residuals
from vision_robot.calibrate.result import Rejected
from vision_robot.calibrate.state import State
from vision_robot.geometry import SE3, Camera
from vision_robot.geometry.hand_eye import HandEye
from vision_robot.types import Array, Float

__all__ = ["HandEyeResult"]


@dataclass(frozen=True)
class HandEyeResult:
    """A hand-eye calibration with everything needed to judge it.

    `state` and `problem` are as the solver left them; `reduced` is the same seen from the arm;
    `corners` are those of the views used, `indices` their place among the views given.
    """

    state: HandEyeState
    problem: HandEyeProblem
    reduced: Reduced
    noise: NoiseEstimate
    noise_px: float
    covariance: HandEyeCovariance
    motion: Motion
    corners: tuple[Corners, ...]
    indices: tuple[int, ...]
    rejected: tuple[Rejected, ...]
    closed_forms: dict[str, tuple[SE3, SE3]]
    """(mount_from_cam, far_from_board) of each closed form, from the same views."""
    iterations: int = 0

    @property
    def setup(self) -> Setup:
        """Who carries what."""
        return self.state.setup

    @property
    def camera(self) -> Camera:
        """The camera, as given or as estimated along."""
        return self.state.pictures.camera

    @property
    def mount_from_cam(self) -> SE3:
        """wrist_from_cam of an eye-in-hand, base_from_cam of an eye-to-hand."""
        return self.state.mount_from_cam

    @property
    def far_from_board(self) -> SE3:
        """base_from_board of an eye-in-hand, wrist_from_board of an eye-to-hand."""
        return self.state.far_from_board

    @property
    def base_from_wrist(self) -> SE3:
        """The arm's poses as it says them, links corrected where they were estimated."""
        return self.state.arm.base_from_wrist

    @property
    def cam_from_board(self) -> SE3:
        """The board's pose in each view, corners and arm together."""
        return self.state.pictures.cam_from_board

    @property
    def geometry(self) -> ArmGeometry | None:
        """The arm's links, where they were estimated."""
        return self.state.arm if isinstance(self.state.arm, ArmGeometry) else None

    @property
    def names(self) -> tuple[str, ...]:
        """Pictures used."""
        return tuple(view.image for view in self.corners)

    @property
    def arm_residuals(self) -> Float[Array, "views 6"]:
        """What the arm says less what the pictures say: turn [rad], shift [m], base axes."""
        return arm_residuals(self.state)

    @property
    def predicted_residuals(self) -> list[Float[Array, "_ 2"]]:
        """Corners where the arm and this calibration predict them less where they were seen [px]."""
        seen = self.problem.pictures.seen
        pictures = self.state.pictures
        said = State(pictures.camera, self.state.predicted_cam_from_board, pictures.warp)
        off = residuals(said, seen)
        return [e[:, present].T for e, present in zip(off, seen.present, strict=True)]

    @property
    def hand_eye(self) -> HandEye:
        """What later work needs of it."""
        return HandEye(
            setup=self.setup.name,
            camera=self.camera,
            mount_from_cam=self.mount_from_cam,
            far_from_board=self.far_from_board,
            covariance=self.covariance.joint,
            arm_turn=self.noise.noise.turn,
            arm_shift_m=self.noise.noise.shift_m,
        )

    @property
    def rms_px(self) -> float:
        """Root mean square of `predicted_residuals` per corner, both axes together [px]."""
        every = np.concatenate(self.predicted_residuals)
        return float(np.sqrt(np.mean(np.sum(every**2, axis=1))))
