"""What the joint refinement is given: corners, the noise of the arm, and what is known beforehand."""

from dataclasses import dataclass, field, replace

import numpy as np

from vision_robot.calibrate.problem import Problem
from vision_robot.types import Array, Bool, Float

__all__ = ["ArmNoise", "HandEyeProblem"]


@dataclass(frozen=True)
class ArmNoise:
    """Standard deviation, per axis, of a turn [rad] and of a shift [m] of the wrist as the arm says it."""

    turn: float
    shift_m: float

    @property
    def variances(self) -> Float[Array, "2"]:
        """Of turn and shift."""
        return np.array([self.turn, self.shift_m]) ** 2

    @property
    def weights(self) -> Float[Array, "6"]:
        """1/sigma of the six numbers of an arm residual."""
        return np.repeat([1 / self.turn, 1 / self.shift_m], 3)


@dataclass(frozen=True)
class HandEyeProblem:
    """Corners weighed by 1/sigma, the arm's noise, and an optional normal prior on the camera's parameters.

    With unit variance throughout, the inverse of the Gauss-Newton matrix is the covariance.
    """

    pictures: Problem
    noise: ArmNoise
    camera_mean: Float[Array, "p"] = field(default_factory=lambda: np.zeros(0))
    camera_information: Float[Array, "p p"] = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def free(self) -> Bool[Array, "p"]:
        """Which of the camera's parameters are estimated."""
        return self.pictures.free

    def with_noise(self, noise: ArmNoise) -> "HandEyeProblem":
        """The same with another noise of the arm."""
        return replace(self, noise=noise)

    def keeping(self, views: Array) -> "HandEyeProblem":
        """Some of the views."""
        return replace(self, pictures=self.pictures.of(self.pictures.seen[views]))

    def camera_prior(
        self, parameters: Float[Array, "p"]
    ) -> tuple[Float[Array, "f f"], Float[Array, "f"], float]:
        """Information, gradient and cost of the prior on the free parameters."""
        f = int(self.free.sum())
        if not len(self.camera_mean):
            return np.zeros((f, f)), np.zeros(f), 0.0
        off = (parameters - self.camera_mean)[self.free]
        information = self.camera_information[np.ix_(self.free, self.free)]
        return information, information @ off, 0.5 * float(off @ information @ off)
