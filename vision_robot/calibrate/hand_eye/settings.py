"""What is asked of a hand-eye calibration."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.arm import GeometryTolerance
from vision_robot.calibrate.hand_eye.problem import ArmNoise
from vision_robot.calibrate.hand_eye.setup import Setup, setup_named
from vision_robot.errors import BadParameter

__all__ = ["HandEyeSettings"]


@dataclass(frozen=True)
class HandEyeSettings:
    """Which set-up, and what is estimated besides.

    `noise` fixes the arm's noise instead of estimating it; `geometry` has the arm's links corrected, where
    joint values and a model are given; `free_camera` estimates the intrinsics as if little were known of
    them; `robust` leaves out views that noise cannot explain.
    """

    setup: str = "eye-in-hand"
    noise: ArmNoise | None = None
    geometry: GeometryTolerance | None = None
    free_camera: bool = False
    robust: bool = True

    def __post_init__(self) -> None:
        setup_named(self.setup)
        given: Mapping[str, float] = (
            {"turn noise of the arm": self.noise.turn, "shift noise of the arm": self.noise.shift_m}
            if self.noise
            else {}
        )
        for name, value in given.items():
            if not (np.isfinite(value) and value > 0):
                raise BadParameter(name, value, "positive")

    @property
    def arrangement(self) -> Setup:
        """Who carries what."""
        return setup_named(self.setup)
