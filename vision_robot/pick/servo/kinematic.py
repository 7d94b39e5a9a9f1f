"""A hand without physics: it is where it is told to be, and a camera sees its label with noise."""

from dataclasses import dataclass, field

import numpy as np

from vision_robot.errors import NothingSeen
from vision_robot.geometry import WorkPlane
from vision_robot.pick.episode import Look
from vision_robot.pick.servo.patience import LABEL_ON_HAND
from vision_robot.pick.servo.stage import Glimpse
from vision_robot.pick.sighting import Sighting
from vision_robot.types import Array, Float

__all__ = ["KinematicStage"]


@dataclass
class KinematicStage:
    """A `Stage` for maps of thousands of runs: true geometry, no forces, no pictures.

    The servos are a lag of first order; a look is the projection through the true camera, and noise.
    """

    plane: WorkPlane
    """As believed."""
    true_plane: WorkPlane
    thing_m: Float[Array, "2"]
    """Where the thing really is; for the record alone."""
    label_over_tool_m: float = 0.06
    noise_px: float = 0.1
    period_s: float = 1 / 30
    latency_s: float = 0.0
    lag_s: float = 0.0
    """Time constant of the servos."""
    lost_sight: float = 0.0
    """Share of pictures in which nothing is seen."""
    dark_from_s: float = np.inf
    """From then on nothing is seen."""
    seed: int = 0
    looks: list[Look] = field(default_factory=list)
    time_s: float = 0.0

    def __post_init__(self) -> None:
        self._chance = np.random.default_rng(self.seed)
        self._real = np.zeros(3)
        self._told = np.zeros(3)

    def go(self, place: Sighting, height_m: float) -> None:
        """At once and exactly."""
        self._real = self._label(place, height_m)
        self._told = self._real

    def step(self, place: Sighting, height_m: float) -> None:
        """One period of the lag."""
        share = 1 - np.exp(-self.period_s / self.lag_s) if self.lag_s > 0 else 1.0
        self._told = self._label(place, height_m)
        self._real = self._real + share * (self._told - self._real)
        self.time_s += self.period_s

    def wait(self, seconds: float) -> None:
        """Until it is where it was told to be."""
        self._real = self._told
        self.time_s += seconds

    def look(self) -> Glimpse:
        """The label through the true camera; raises NothingSeen outside the picture and when lost."""
        camera = self.true_plane.camera
        pixel = self.true_plane.pixels(self._real[None, :2], z_m=float(self._real[2]))[0]
        inside = ((pixel >= 0) & (pixel <= [camera.width - 1, camera.height - 1])).all()  # not where NaN
        if not inside or self.time_s >= self.dark_from_s or self._chance.random() < self.lost_sight:
            raise NothingSeen("kinematic", LABEL_ON_HAND)
        noisy = pixel + self._chance.normal(0, self.noise_px, 2)
        return Glimpse(self.time_s, noisy, self._told, self.noise_px)

    def note(self, error_m: float, sigma_m: float = np.nan) -> None:
        """With how far the label really is off the thing."""
        off = float(np.linalg.norm(self._real[:2] - self.thing_m))
        self.looks.append(Look(self.time_s, error_m, float(self._real[2]), off, sigma_m))

    def _label(self, place: Sighting, height_m: float) -> Float[Array, "3"]:
        return np.array([*place.position_m, place.height_m + height_m + self.label_over_tool_m])
