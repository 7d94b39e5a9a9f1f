"""Answers judged when they are there (streaming accuracy; Li, Wang & Ramanan 2020)."""

import numpy as np

from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float, Int

__all__ = ["answered_frames", "streamed"]


def answered_frames(times_s: Float[Array, "f"], latency_s: Float[Array, "f"]) -> Int[Array, "f"]:
    """For each frame's moment, the frame whose answer is the newest there; -1 where there is none yet.

    One worker takes the newest frame whenever it is free, for as long as that frame takes, and lets
    the frames in between go.
    """
    done_at, of_frame = [], []
    free, last = -np.inf, -1
    while True:
        waiting = int(np.searchsorted(times_s, free, side="right")) - 1
        begin = max(waiting, last + 1)
        if begin >= len(times_s):
            break
        free = max(free, float(times_s[begin])) + float(latency_s[begin])
        done_at.append(free)
        of_frame.append(begin)
        last = begin
    newest = np.searchsorted(np.array(done_at), times_s, side="right") - 1
    return np.where(newest >= 0, np.array([*of_frame, -1])[newest], -1)


def streamed(answer: Tracks, times_s: Float[Array, "f"], latency_s: Float[Array, "f"]) -> Tracks:
    """What someone has who asks at each frame's moment: older answers stand in for newer frames."""
    source = answered_frames(times_s, latency_s)
    rows, frames = [], []
    for frame, origin in enumerate(source):
        found = np.flatnonzero(answer.frame == origin)
        rows.append(found)
        frames.append(np.full(len(found), frame))
    if not rows:
        return Tracks.empty()
    late = answer.rows(np.concatenate(rows))
    frame = np.concatenate(frames)
    columns = {name: getattr(late, name) for name in late.__dataclass_fields__}
    return Tracks(**{**columns, "frame": frame, "time_s": times_s[frame]})
