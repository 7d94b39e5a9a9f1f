"""Who is where when: things of one height keep clear of each other."""

from dataclasses import dataclass, field

import numpy as np

from vision_robot.sim.paths import Path
from vision_robot.types import Array, Bool, Float, Int

__all__ = ["Footprint", "Traffic"]

STEP_S = 0.1
CLEARANCE_M = 0.004


@dataclass(frozen=True)
class Footprint:
    """A thing from above: a strip of a length with round ends, as wide as `width_m`."""

    length_m: float
    width_m: float
    above_m: float

    def ends(self, places: Float[Array, "n 4"]) -> Float[Array, "n 2 2"]:
        """The two ends of the strip's middle line at places (x, y, height, yaw)."""
        half = max(self.length_m - self.width_m, 0) / 2
        along = half * np.stack([np.cos(places[:, 3]), np.sin(places[:, 3])], axis=1)
        return np.stack([places[:, :2] - along, places[:, :2] + along], axis=1)


@dataclass
class Traffic:
    """The motions planned so far, at steps of time up to `duration_s`."""

    duration_s: float
    planned: list[tuple[Footprint, Float[Array, "times 2 2"]]] = field(default_factory=list)

    @property
    def times_s(self) -> Float[Array, "times"]:
        """The times at which motions are looked at."""
        return np.arange(int(np.ceil(self.duration_s / STEP_S)) + 1) * STEP_S

    def places(self, path: Path) -> Float[Array, "times 4"]:
        """Where a motion is at those times."""
        return np.array([path.at(float(time)) for time in self.times_s])

    def add(self, footprint: Footprint, places: Float[Array, "times 4"]) -> None:
        """Plan it in."""
        self.planned.append((footprint, footprint.ends(places)))

    def free(
        self, footprint: Footprint, places: Float[Array, "*ways k 4"], steps: Int[Array, "*ways k"]
    ) -> Bool[Array, "*ways k"]:
        """Which of these places, each at its own step of time, are clear of all that is planned."""
        shape = places.shape[:-1]
        mine, when = footprint.ends(places.reshape(-1, 4)), np.broadcast_to(steps, shape).ravel()
        middle = mine.mean(axis=1)
        clear = np.ones(len(mine), dtype=bool)
        for other, ends in self.planned:
            if abs(other.above_m - footprint.above_m) > 1e-9:
                continue
            theirs = ends[np.minimum(when, len(ends) - 1)]
            apart = (footprint.width_m + other.width_m) / 2 + CLEARANCE_M
            # Most are so far away that their lengths do not matter.
            reach = (footprint.length_m + other.length_m) / 2 + apart
            far = ((theirs.mean(axis=1) - middle) ** 2).sum(axis=1) > reach**2
            asked = np.flatnonzero(clear & ~far)
            clear[asked] = _distance(mine[asked], theirs[asked]) > apart
        return clear.reshape(shape)


def _distance(a: Float[Array, "k 2 2"], b: Float[Array, "k 2 2"]) -> Float[Array, "k"]:
    """Distance between strips' middle lines: 0 where they cross, else that of an end to the other line."""
    ends = [_to_line(a[:, 0], b), _to_line(a[:, 1], b), _to_line(b[:, 0], a), _to_line(b[:, 1], a)]
    crossed = (_side(a[:, 0], b) * _side(a[:, 1], b) < 0) & (_side(b[:, 0], a) * _side(b[:, 1], a) < 0)
    return np.where(crossed, 0.0, np.min(ends, axis=0))


def _to_line(point: Float[Array, "k 2"], line: Float[Array, "k 2 2"]) -> Float[Array, "k"]:
    start, along = line[:, 0], line[:, 1] - line[:, 0]
    square = np.maximum((along**2).sum(axis=1), 1e-18)
    share = np.clip(((point - start) * along).sum(axis=1) / square, 0, 1)
    return np.linalg.norm(point - start - share[:, None] * along, axis=1)


def _side(point: Float[Array, "k 2"], line: Float[Array, "k 2 2"]) -> Float[Array, "k"]:
    along, to = line[:, 1] - line[:, 0], point - line[:, 0]
    return along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]
