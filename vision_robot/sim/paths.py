"""Motions over the table that are known exactly: where an item is and how fast, at every time."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float

__all__ = ["Circle", "Path", "Straight", "Sum", "Sway", "Waypoints"]

Four = tuple[float, float, float, float]


@runtime_checkable
class Path(Protocol):
    """A motion over the table: x, y, height above rest [m] and yaw [rad] in {S}, and their rates."""

    def at(self, time_s: float) -> Float[Array, "4"]:
        """Where it is: (x, y, height above rest, yaw)."""
        ...

    def rate(self, time_s: float) -> Float[Array, "4"]:
        """How fast: the derivative of `at` [m/s, rad/s]; where it jumps, the one that follows."""
        ...


@dataclass(frozen=True)
class Straight:
    """From `start` at a steady `velocity`, both (x, y, height, yaw)."""

    start: Four
    velocity: Four = (0.0, 0.0, 0.0, 0.0)

    def at(self, time_s: float) -> Float[Array, "4"]:
        """Where it is."""
        return np.array(self.start) + time_s * np.array(self.velocity)

    def rate(self, time_s: float) -> Float[Array, "4"]:
        """How fast."""
        del time_s
        return np.array(self.velocity, dtype=float)


@dataclass(frozen=True)
class Waypoints:
    """Through `places` (x, y, height, yaw) at `times_s`, evenly between two; at rest before and after.

    Two equal places in a row are a stop.
    """

    times_s: tuple[float, ...]
    places: tuple[Four, ...]

    def __post_init__(self) -> None:
        if len(self.times_s) != len(self.places) or len(self.times_s) < 2:
            raise BadParameter(
                "way points", (len(self.times_s), len(self.places)), "two or more, as many times"
            )
        if not (np.diff(self.times_s) > 0).all():
            raise BadParameter("times of way points", self.times_s, "rising")

    def at(self, time_s: float) -> Float[Array, "4"]:
        """Where it is."""
        places = np.array(self.places, dtype=float)
        return np.array([np.interp(time_s, self.times_s, column) for column in places.T])

    def rate(self, time_s: float) -> Float[Array, "4"]:
        """How fast."""
        if not self.times_s[0] <= time_s < self.times_s[-1]:
            return np.zeros(4)
        i = int(np.searchsorted(self.times_s, time_s, side="right")) - 1
        gone = np.array(self.places[i + 1]) - np.array(self.places[i])
        return gone / (self.times_s[i + 1] - self.times_s[i])


@dataclass(frozen=True)
class Circle:
    """Round `centre_m` (x, y) at `radius_m`, `turn_rad_s` a second, from angle `phase_rad`.

    The yaw turns at `spin_rad_s` from `yaw_rad`; with None it follows the circle.
    """

    centre_m: tuple[float, float]
    radius_m: float
    turn_rad_s: float
    phase_rad: float = 0.0
    yaw_rad: float = 0.0
    spin_rad_s: float | None = None

    def at(self, time_s: float) -> Float[Array, "4"]:
        """Where it is."""
        angle = self.phase_rad + self.turn_rad_s * time_s
        spin = self.turn_rad_s if self.spin_rad_s is None else self.spin_rad_s
        (x, y), r = self.centre_m, self.radius_m
        return np.array([x + r * np.cos(angle), y + r * np.sin(angle), 0.0, self.yaw_rad + spin * time_s])

    def rate(self, time_s: float) -> Float[Array, "4"]:
        """How fast."""
        angle, turn = self.phase_rad + self.turn_rad_s * time_s, self.turn_rad_s
        spin = turn if self.spin_rad_s is None else self.spin_rad_s
        return np.array(
            [-self.radius_m * turn * np.sin(angle), self.radius_m * turn * np.cos(angle), 0.0, spin]
        )


@dataclass(frozen=True)
class Sway:
    """To and fro about `middle` by `reach` (x, y, height, yaw), as a sine of `period_s`."""

    middle: Four
    reach: Four
    period_s: float
    phase_rad: float = 0.0

    def __post_init__(self) -> None:
        if not self.period_s > 0:
            raise BadParameter("period", self.period_s, "positive")

    def at(self, time_s: float) -> Float[Array, "4"]:
        """Where it is."""
        angle = 2 * np.pi * time_s / self.period_s + self.phase_rad
        return np.array(self.middle) + np.sin(angle) * np.array(self.reach)

    def rate(self, time_s: float) -> Float[Array, "4"]:
        """How fast."""
        turn = 2 * np.pi / self.period_s
        return turn * np.cos(turn * time_s + self.phase_rad) * np.array(self.reach)


@dataclass(frozen=True)
class Sum:
    """Several motions at once: their places and rates added up."""

    parts: tuple[Path, ...]

    def at(self, time_s: float) -> Float[Array, "4"]:
        """Where it is."""
        return np.sum([part.at(time_s) for part in self.parts], axis=0)

    def rate(self, time_s: float) -> Float[Array, "4"]:
        """How fast."""
        return np.sum([part.rate(time_s) for part in self.parts], axis=0)
