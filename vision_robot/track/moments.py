"""Moments of blobs up to the second order, and the ellipses that have them."""

from dataclasses import dataclass

import numpy as np

from vision_robot.track.runs import Runs
from vision_robot.types import Array, Float, Int

__all__ = ["Moments", "ellipses"]

PIXEL = 1 / 12
"""Second moment of a pixel about its own centre, which sums over pixel centres leave out."""

ROUND = 1e-9


@dataclass(frozen=True)
class Moments:
    """Sums over the pixels of each blob, about an origin of its own, so that no digits cancel.

    `sums` has the columns weight, u, v, u u, u v, v v.
    """

    origin: Float[Array, "n 2"]
    sums: Float[Array, "n 6"]

    @classmethod
    def of_runs(cls, runs: Runs, origin: Float[Array, "n 2"]) -> "Moments":
        """Every pixel with weight 1; `origin` has a row for each of the blobs 1 to n."""
        n, at = len(origin), runs.label - 1
        a = runs.first - origin[at, 0]
        length = (runs.stop - runs.first).astype(float)
        b = a + length - 1
        v = runs.v - origin[at, 1]
        u = length * (a + b) / 2
        uu = length * (2 * (a * a + a * b + b * b) + b - a) / 6
        return cls(origin, _summed(at, n, (length, u, length * v, uu, u * v, length * v * v)))

    @classmethod
    def of_pixels(
        cls,
        at: Int[Array, "k"],
        u: Array,
        v: Array,
        weight: Array,
        origin: Float[Array, "n 2"],
    ) -> "Moments":
        """Pixels (u, v) of any weight; `at` is the row of the blob each belongs to."""
        u, v = u - origin[at, 0], v - origin[at, 1]
        wu, wv = weight * u, weight * v
        return cls(origin, _summed(at, len(origin), (weight, wu, wv, wu * u, wu * v, wv * v)))

    def __add__(self, other: "Moments") -> "Moments":
        """Moments of both sets of pixels together, about the same origins."""
        return Moments(self.origin, self.sums + other.sums)

    @property
    def weight(self) -> Float[Array, "n"]:
        """Sum of weights; the area [px] where all are 1."""
        return self.sums[:, 0]

    @property
    def centroid(self) -> Float[Array, "n 2"]:
        """Centres [px]."""
        return self.origin + self.sums[:, 1:3] / self.weight[:, None]

    @property
    def covariance(self) -> Float[Array, "n 2 2"]:
        """Second moments about the centroid, for weight 1 [px²]."""
        mean = self.sums[:, 1:3] / self.weight[:, None]
        second = self.sums[:, [3, 4, 4, 5]].reshape(-1, 2, 2) / self.weight[:, None, None]
        return second - mean[:, :, None] * mean[:, None, :]


def ellipses(
    covariance: Float[Array, "n 2 2"], *, pixels_are_squares: bool
) -> tuple[Float[Array, "n 2"], Float[Array, "n"]]:
    """Axes (full lengths, major first) and yaw of the ellipses with these second moments.

    With `pixels_are_squares` each pixel's own second moment of 1/12 is added, as MATLAB's regionprops does
    and as makes the axes of a large disc its diameter; without it they are scikit-image's. Yaw is NaN
    where no direction is longer than another.
    """
    uu, uv, vv = covariance[:, 0, 0], covariance[:, 0, 1], covariance[:, 1, 1]
    middle, half = (uu + vv) / 2, np.hypot((uu - vv) / 2, uv)
    own = PIXEL if pixels_are_squares else 0.0
    axes = 4 * np.sqrt(np.clip(np.stack([middle + half, middle - half], axis=1) + own, 0, None))
    yaw = np.where(half > ROUND * np.maximum(middle, PIXEL), np.arctan2(2 * uv, uu - vv) / 2, np.nan)
    return axes, np.where(yaw >= np.pi / 2, yaw - np.pi, yaw)


def _summed(at: Int[Array, "k"], n: int, columns: tuple[Array, ...]) -> Float[Array, "n 6"]:
    return np.stack([np.bincount(at, column, minlength=n) for column in columns], axis=1)
