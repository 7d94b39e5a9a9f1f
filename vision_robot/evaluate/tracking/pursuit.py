"""A tracker on a labelled video: what it answers, when, and how long it takes."""

from collections.abc import Iterable
from dataclasses import dataclass
from time import perf_counter, process_time

import numpy as np

from vision_robot.geometry.work_plane import WorkPlane
from vision_robot.track.follow import Follower
from vision_robot.track.on_plane import OnPlane
from vision_robot.track.tracker import LooksAhead, Tracker
from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float
from vision_robot.video import Frame

__all__ = ["Pursuit", "pursue"]


@dataclass(frozen=True)
class Pursuit:
    """Tracks of a whole video, and times of every frame."""

    tracks: Tracks
    """What is known in the end: no row of a confirmed object is missing."""
    live: Tracks
    """What was known when each frame had been looked at: confirmed objects alone."""
    latency_s: Float[Array, "frames"]
    """From having a frame to having its answer."""
    cpu_s: float
    """Processor time of all of them together."""


def pursue(
    tracker: Tracker,
    frames: Iterable[Frame],
    size: tuple[int, int],
    *,
    plane: WorkPlane | None = None,
    z_m: float = 0.0,
) -> Pursuit:
    """All frames through a tracker and the association that `vr track` uses.

    `frames` can be gone through again: whoever can learn from the beginning of a recording may, and the
    time for that is nobody's latency. Getting frames and carrying rows to the plane is not timed.
    """
    if isinstance(tracker, LooksAhead):
        tracker.learn((frame.image, frame.time_s) for frame in frames)
    follower = Follower(size)
    final: list[Tracks] = []
    live: list[Tracks] = []
    latency: list[float] = []
    cpu_s = 0.0
    for frame in frames:
        start, begun = perf_counter(), process_time()
        rows = follower.step(frame.index, frame.time_s, tracker.step(frame.image, frame.time_s))
        cpu_s += process_time() - begun
        latency.append(perf_counter() - start)
        final.append(rows)
        live.append(follower.now())
    final += follower.finish()
    if plane is not None:
        on_plane = OnPlane(plane, size, z_m=z_m)
        final = [on_plane.carry(rows) for rows in final]
    return Pursuit(Tracks.joined(final), Tracks.joined(live), np.array(latency), cpu_s)
