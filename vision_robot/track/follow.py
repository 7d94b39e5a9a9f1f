"""From blobs frame by frame to tracks: which blob is which object, from birth to death.

Each frame's blobs are assigned to the predicted tracks so that the total likelihood is largest (Hungarian
method), inside a chi-squared gate. A track is born of a blob nobody claims, confirmed when it is seen again,
kept through occlusion for a while, and ends.
"""

from collections import deque
from dataclasses import dataclass, fields

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.track.blobs import Blobs
from vision_robot.track.motion import GATE, Motion
from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float, Int

__all__ = ["FollowOptions", "Follower"]

AREA_SPREAD = 0.35
"""Standard deviation of the logarithm of an object's area from frame to frame."""

ROUND = 1.15
"""Ratio of axes below which a direction is noise."""

SIGMA_PX, SIGMA_OF_SIZE = 0.15, 0.02
"""Error of a whole blob's centroid for the filter: a constant, and a share of the root of its area."""

PART_OF_SIZE = 0.15
"""What a blob's centroid may be off when something covers a part of it or joins it: for the gate."""

LEAST_SIGMA_PX = 0.02
"""No centroid is known better than the best measured ones."""

FORBIDDEN = 1e6
SMOOTH = 0.2


@dataclass(frozen=True)
class FollowOptions:
    """How blobs become tracks."""

    confirm: int = 3
    """Sightings before a track counts."""
    max_gap_s: float = 1.0
    """How long an object may be out of sight and keep its id."""
    max_objects: int | None = None
    """Where it is known how many there are at once: no more are named."""

    def __post_init__(self) -> None:
        if self.confirm < 1:
            raise BadParameter("confirm", self.confirm, "1 or more")
        if not (np.isfinite(self.max_gap_s) and self.max_gap_s >= 0):
            raise BadParameter("max_gap_s", self.max_gap_s, "0 or more seconds")
        if self.max_objects is not None and self.max_objects < 1:
            raise BadParameter("max_objects", self.max_objects, "1 or more")


@dataclass(frozen=True)
class _Lives:
    """What is known of each track besides its motion, one row each."""

    id: Int[Array, "n"]
    hits: Int[Array, "n"]
    seen_s: Float[Array, "n"]
    area: Float[Array, "n"]
    kind: Int[Array, "n"]
    yaw: Float[Array, "n"]
    turning: Float[Array, "n"]
    missed: Int[Array, "n"]
    """Frames since it was seen."""
    error_px: Float[Array, "n"]
    """Running rms per axis of what the filter leaves."""

    def __len__(self) -> int:
        return len(self.id)

    def rows(self, keep: Array) -> "_Lives":
        return _Lives(*(getattr(self, one.name)[keep] for one in fields(self)))

    def joined(self, other: "_Lives") -> "_Lives":
        pairs = ((getattr(self, one.name), getattr(other, one.name)) for one in fields(self))
        return _Lives(*(np.concatenate(pair) for pair in pairs))


class Follower:
    """Gives blobs their ids. Rows come `confirm` - 1 frames late, so that none of a track is missing."""

    def __init__(self, size: tuple[int, int], options: FollowOptions | None = None):
        """For frames of this (width, height)."""
        self.options = options or FollowOptions()
        self._size = size
        none, whole = np.zeros(0), np.zeros(0, dtype=np.int64)
        self._lives = _Lives(whole, whole, none, none, whole, none, none, whole, none)
        self._motion = Motion.start(np.zeros((0, 2)), none, none, 1.0)
        self._before = self._motion.position
        self._time_s = np.nan
        self._next = 1
        self._names: dict[int, int] = {}
        self._waiting: deque[Tracks] = deque()

    @property
    def confirmed(self) -> int:
        """Objects confirmed so far."""
        return len(self._names)

    def step(self, frame: int, time_s: float, blobs: Blobs) -> Tracks:
        """Follow one frame further; the rows of a frame `confirm` - 1 before it, for confirmed tracks."""
        dt = 0.0 if np.isnan(self._time_s) else time_s - self._time_s
        self._time_s = time_s
        self._before = self._motion.position
        self._motion = self._motion.predicted(dt)
        self._bury(time_s)
        row = self._assigned(blobs)
        free = np.flatnonzero(row < 0)
        born = self._born(blobs.rows(free), time_s, dt)
        self._update(blobs, row, time_s, dt)
        at = row.copy()
        at[free] = len(self._lives) + np.arange(len(free))
        self._motion, self._lives = self._motion.joined(born[0]), self._lives.joined(born[1])
        self._name()
        self._waiting.append(self._table(frame, time_s, blobs, at))
        if len(self._waiting) < self.options.confirm:
            return Tracks.empty()
        return self._ripe(self._waiting.popleft())

    def now(self) -> Tracks:
        """The rows of the last frame, for tracks confirmed already; for live use."""
        return self._ripe(self._waiting[-1]) if self._waiting else Tracks.empty()

    def finish(self) -> list[Tracks]:
        """The rows still waiting, frame by frame."""
        rest = [self._ripe(rows) for rows in self._waiting]
        self._waiting.clear()
        return rest

    def _ripe(self, rows: Tracks) -> Tracks:
        """Rows of confirmed tracks under their numbers."""
        number = np.array([self._names.get(one, 0) for one in rows.id.tolist()], dtype=np.int64)
        kept = rows.rows(number > 0)
        order = np.argsort(number[number > 0])
        columns = {one.name: getattr(kept, one.name) for one in fields(Tracks)}
        return Tracks(**{**columns, "id": number[number > 0]}).rows(order)

    def _assigned(self, blobs: Blobs) -> Int[Array, "m"]:
        """Row of the track that each blob continues, -1 for none."""
        row = np.full(len(blobs), -1)
        if not len(blobs) or not len(self._lives):
            return row
        sigma = PART_OF_SIZE * np.sqrt(blobs.area_px) + SIGMA_PX
        distance = self._motion.distance(blobs.centroid_px, sigma)
        change = np.log(blobs.area_px[None] / self._lives.area[:, None]) / AREA_SPREAD
        possible = (distance < GATE) & (self._lives.kind[:, None] == blobs.kind[None])
        # What was seen more often has the better claim.
        claim = 2 * np.log1p(self._lives.hits[:, None])
        cost = self._motion.cost(distance, sigma) + np.minimum(change**2, 9.0) - claim
        if self._is_plain(possible):
            track, blob = np.nonzero(possible)
        else:
            from scipy.optimize import linear_sum_assignment

            track, blob = linear_sum_assignment(np.where(possible, cost, FORBIDDEN))
            kept = possible[track, blob]
            track, blob = track[kept], blob[kept]
        row[blob] = track
        self._knocked(blobs, row)
        return row

    def _knocked(self, blobs: Blobs, row: Int[Array, "m"]) -> None:
        """Give blobs nobody expected to tracks that miss theirs: what is bumped into turns at once.

        A track seen in the frame before is within its own length, or as far as it went before, of where
        it was; the nearest pair goes first.
        """
        free = np.flatnonzero(row < 0)
        lost = np.setdiff1d(np.flatnonzero((self._lives.missed == 0) & (self._lives.hits > 1)), row)
        if not len(free) or not len(lost):
            return
        some, life = blobs.rows(free), self._lives.rows(lost)
        apart = np.linalg.norm(self._before[lost][:, None] - some.centroid_px[None], axis=2)
        went = np.linalg.norm(self._motion.position[lost] - self._before[lost], axis=1)
        reach = np.maximum(np.maximum(some.axes_px[:, 0], np.sqrt(some.area_px)), went[:, None])
        change = np.abs(np.log(some.area_px[None] / life.area[:, None]))
        possible = (apart < reach) & (change < 2 * AREA_SPREAD) & (life.kind[:, None] == some.kind[None])
        while possible.any():
            t, b = np.unravel_index(np.where(possible, apart, np.inf).argmin(), possible.shape)
            row[free[b]] = lost[t]
            possible[t], possible[:, b] = False, False

    @staticmethod
    def _is_plain(possible: Array) -> bool:
        """Whether nobody has a choice, as is usual with few objects."""
        return bool(possible.sum(axis=0).max() <= 1 and possible.sum(axis=1).max() <= 1)

    def _update(self, blobs: Blobs, row: Int[Array, "m"], time_s: float, dt: float) -> None:
        blob = np.flatnonzero(row >= 0)
        track = row[blob]
        self._lives.missed[:] += 1
        if not len(blob):
            return
        seen, before = blobs.rows(blob), self._motion.rows(track)
        # A blob that has just lost or won a part of its area has its centroid elsewhere.
        change = np.abs(np.log(seen.area_px / self._lives.area[track]))
        sigma = _sigma(seen.area_px) + PART_OF_SIZE * np.sqrt(seen.area_px) * np.clip(change - 0.05, 0, 2)
        after = before.updated(seen.centroid_px, sigma, dt, learn=self._lives.hits[track] > 1)
        for name in ("position", "velocity", "covariance", "acceleration"):
            getattr(self._motion, name)[track] = getattr(after, name)
        life = self._lives
        life.hits[track] += 1
        life.seen_s[track], life.missed[track] = time_s, 0
        life.area[track] *= (seen.area_px / life.area[track]) ** SMOOTH
        rest = np.sqrt(((seen.centroid_px - after.position) ** 2).sum(axis=1) / 2)
        life.error_px[track] = np.hypot(np.sqrt(1 - SMOOTH) * life.error_px[track], np.sqrt(SMOOTH) * rest)
        self._turn(track, _direction(seen), dt)

    def _turn(self, track: Int[Array, "k"], yaw: Float[Array, "k"], dt: float) -> None:
        """Directions go on from where they were: an axis looks the same after half a turn."""
        life = self._lives
        expected = life.yaw[track] + dt * life.turning[track]
        whole = yaw + np.pi * np.rint((expected - yaw) / np.pi)
        fresh = np.isnan(expected)
        new = np.where(fresh, yaw, whole)
        if dt > 0:
            rate = np.where(fresh, 0, (new - life.yaw[track]) / dt)
            life.turning[track] += SMOOTH * np.nan_to_num(rate - life.turning[track])
        life.yaw[track] = np.where(np.isnan(new), life.yaw[track], new)

    def _born(self, blobs: Blobs, time_s: float, dt: float) -> tuple[Motion, _Lives]:
        n, size = len(blobs), np.sqrt(np.maximum(blobs.area_px, 1))
        # An object moves less than about its own length from one frame to the next.
        length = np.maximum(blobs.axes_px[:, 0], size)
        speed = np.minimum(length / dt if dt > 0 else 25 * length, 2.0 * max(self._size))
        acceleration = 0.5 * max(self._size)
        motion = Motion.start(blobs.centroid_px, _sigma(blobs.area_px), speed, acceleration)
        lives = _Lives(
            id=np.arange(self._next, self._next + n),
            hits=np.ones(n, dtype=np.int64),
            seen_s=np.full(n, time_s),
            area=blobs.area_px.copy(),
            kind=blobs.kind.copy(),
            yaw=_direction(blobs),
            turning=np.zeros(n),
            missed=np.zeros(n, dtype=np.int64),
            error_px=_sigma(blobs.area_px),
        )
        self._next += n
        return motion, lives

    def _bury(self, time_s: float) -> None:
        """End what has been out of sight for too long, or has left the picture."""
        life, place = self._lives, self._motion.position
        margin = np.sqrt(life.area)[:, None] / 2
        inside = ((place > -margin) & (place < np.array(self._size) + margin)).all(axis=1)
        remembered = (life.hits >= self.options.confirm) & (time_s - life.seen_s <= self.options.max_gap_s)
        alive = inside & (remembered | (life.missed <= 1))
        self._motion, self._lives, self._before = (
            self._motion.rows(alive),
            life.rows(alive),
            self._before[alive],
        )

    def _name(self) -> None:
        """Number what is confirmed; what only comes and goes leaves no gaps in the numbers."""
        most = self.options.max_objects
        for one in self._lives.id[self._lives.hits >= self.options.confirm].tolist():
            alive = sum(other in self._names for other in self._lives.id.tolist()) if most else 0
            if one not in self._names and (most is None or alive < most):
                self._names[one] = len(self._names) + 1

    def _table(self, frame: int, time_s: float, blobs: Blobs, at: Int[Array, "m"]) -> Tracks:
        """The blobs as rows, with what is known of their tracks."""
        life, motion = self._lives.rows(at), self._motion.rows(at)
        n = len(blobs)
        known = life.hits > 1
        velocity = np.where(known[:, None], motion.velocity, np.nan)
        speed_sigma = np.where(known, np.sqrt(motion.covariance[:, 1, 1]), np.nan)
        return Tracks(
            frame=np.full(n, frame),
            time_s=np.full(n, time_s),
            id=life.id,
            centroid_px=blobs.centroid_px,
            box_px=blobs.box_px,
            area_px=blobs.area_px,
            axes_px=blobs.axes_px,
            yaw_rad=np.where(np.isnan(_direction(blobs)), np.nan, life.yaw),
            position_m=np.full((n, 2), np.nan),
            velocity_m_s=np.full((n, 2), np.nan),
            extra={
                "vu_px_s": velocity[:, 0],
                "vv_px_s": velocity[:, 1],
                "sigma_px": np.clip(life.error_px, LEAST_SIGMA_PX, None),
                "sigma_v_px_s": speed_sigma,
                "turn_deg_s": np.where(known, np.degrees(life.turning), np.nan),
                "kind": blobs.kind.astype(float),
                "score": blobs.score,
            },
        )


def _sigma(area_px: Float[Array, "n"]) -> Float[Array, "n"]:
    return SIGMA_PX + SIGMA_OF_SIZE * np.sqrt(area_px)


def _direction(blobs: Blobs) -> Float[Array, "n"]:
    """Yaw of what is long enough to have one."""
    major, minor = blobs.axes_px.T
    return np.where(major > ROUND * minor, blobs.yaw_rad, np.nan)
