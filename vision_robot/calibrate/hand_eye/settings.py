"""What is asked of a hand-eye calibration."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.arm import GeometryTolerance
from vision_robot.calibrate.hand_eye.problem import ArmNoise
from vision_robot.calibrate.hand_eye.setup import Setup, setup_named
from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float

__all__ = ["CameraKnowledge", "HandEyeSettings"]


@dataclass(frozen=True)
class CameraKnowledge:
    """Covariance (p, p) of Camera.parameters from its own calibration; zero rows are held.

    With it the camera is estimated along; `None` in the settings takes it as exact.
    """

    covariance: Float[Array, "p p"]

    @property
    def free(self) -> Array:
        """Which parameters are uncertain."""
        return np.diag(self.covariance) > 0

    @property
    def information(self) -> Float[Array, "p p"]:
        """Its inverse over the free parameters, zero elsewhere."""
        free = np.flatnonzero(self.free)
        part = self.covariance[np.ix_(free, free)]
        scale = np.sqrt(np.diag(part))
        whole = np.zeros_like(self.covariance)
        whole[np.ix_(free, free)] = np.linalg.pinv(part / np.outer(scale, scale), hermitian=True) / np.outer(
            scale, scale
        )
        return whole


@dataclass(frozen=True)
class HandEyeSettings:
    """Which set-up, and what is estimated besides.

    `noise` fixes the arm's noise instead of estimating it; `geometry` has the arm's links corrected, where
    joint values and a model are given; `camera` is how well the intrinsics are known; `robust`
    leaves out views that noise cannot explain.
    """

    setup: str = "eye-in-hand"
    noise: ArmNoise | None = None
    geometry: GeometryTolerance | None = None
    camera: CameraKnowledge | None = None
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
