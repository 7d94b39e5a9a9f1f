"""Constant velocity with random acceleration: the Kalman filter of all tracks at once.

State of a track: u, v [px] and their rates [px/s]; the axes are independent and share one 2x2 covariance.
The size of the acceleration is found from the data, track by track: a filter whose predictions miss by more
than it says is told to expect more.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["GATE", "Motion"]

GATE = 13.82
"""Squared Mahalanobis distance (two degrees of freedom) that 0.1 % of true matches exceed."""

LEARNING = 0.15
"""How fast a track's acceleration follows its surprises."""

KNOCK = 4.0
"""Squared miss over its variance, per axis, from which a track has been knocked."""

FASTEST_STEP = 3.0
"""Largest factor on the acceleration's variance in one frame."""


@dataclass(frozen=True)
class Motion:
    """Positions and velocities of n tracks with their uncertainty."""

    position: Float[Array, "n 2"]
    velocity: Float[Array, "n 2"]
    covariance: Float[Array, "n 2 2"]
    """Of (position, velocity) along either axis."""
    acceleration: Float[Array, "n"]
    """Standard deviation of the acceleration [px/s²] that lasts for about a frame."""

    @classmethod
    def start(
        cls,
        position: Float[Array, "n 2"],
        sigma_px: Float[Array, "n"],
        speed: Float[Array, "n"],
        acceleration: float,
    ) -> "Motion":
        """Seen once: nothing is known of the velocity but its usual size [px/s]."""
        n = len(position)
        covariance = np.zeros((n, 2, 2))
        covariance[:, 0, 0], covariance[:, 1, 1] = sigma_px**2, speed**2
        return cls(np.array(position), np.zeros((n, 2)), covariance, np.full(n, acceleration))

    def __len__(self) -> int:
        return len(self.position)

    def rows(self, keep: Array) -> "Motion":
        """Some of the tracks."""
        return Motion(
            self.position[keep], self.velocity[keep], self.covariance[keep], self.acceleration[keep]
        )

    def joined(self, other: "Motion") -> "Motion":
        """These tracks, then the others."""
        pairs = ((getattr(self, name), getattr(other, name)) for name in self.__dataclass_fields__)
        return Motion(*(np.concatenate(pair) for pair in pairs))

    def predicted(self, dt: float) -> "Motion":
        """`dt` seconds later."""
        step = np.array([[1.0, dt], [0.0, 1.0]])
        noise = np.array([[dt**4 / 4, dt**3 / 2], [dt**3 / 2, dt**2]])
        grown = step @ self.covariance @ step.T + self.acceleration[:, None, None] ** 2 * noise
        return Motion(self.position + dt * self.velocity, self.velocity, grown, self.acceleration)

    def distance(self, seen: Float[Array, "m 2"], sigma_px: Float[Array, "m"]) -> Float[Array, "n m"]:
        """Squared Mahalanobis distance of each position seen to each track."""
        apart = ((self.position[:, None] - seen[None]) ** 2).sum(axis=2)
        return apart / self._spread(sigma_px[None])

    def cost(self, distance: Float[Array, "n m"], sigma_px: Float[Array, "m"]) -> Float[Array, "n m"]:
        """Twice the negative log likelihood, up to a constant: what an assignment should make least."""
        return distance + 2 * np.log(self._spread(sigma_px[None]))

    def updated(
        self, seen: Float[Array, "n 2"], sigma_px: Float[Array, "n"], dt: float, *, learn: Array
    ) -> "Motion":
        """Each track corrected by where it was seen, `dt` seconds after it was predicted from.

        `learn` tells whose acceleration is to follow its surprises. A miss that noise does not explain is
        taken for a knock: the velocity before it is worth nothing.
        """
        missed = seen - self.position
        square = (missed**2).sum(axis=1) / 2
        surprise = square / (self.covariance[:, 0, 0] + sigma_px**2)
        knock = np.where(surprise > KNOCK, square, 0.0)[:, None, None]
        step = np.array([[1.0, 1 / dt], [1 / dt, 1 / dt**2]]) if dt > 0 else np.zeros((2, 2))
        covariance = self.covariance + knock * step
        spread = covariance[:, 0, 0] + sigma_px**2
        gain = covariance[:, :, 0] / spread[:, None]
        factor = np.clip(1 + LEARNING * (surprise - 1), 1 / FASTEST_STEP, FASTEST_STEP)
        return Motion(
            self.position + gain[:, :1] * missed,
            self.velocity + gain[:, 1:] * missed,
            covariance - gain[:, :, None] * covariance[:, None, 0],
            np.where(learn, np.clip(self.acceleration * np.sqrt(factor), 1.0, 1e5), self.acceleration),
        )

    def _spread(self, sigma_px: Array) -> Array:
        return self.covariance[:, 0, 0][:, None] + sigma_px**2
