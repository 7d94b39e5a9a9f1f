"""The background of a fixed camera: the exact median of each pixel over a span of time.

Frames enter the window strip by strip: each strip of rows takes the frames that come when it is due, so
that the work is the same for every frame. Within a strip the median is exact over what the strip took in.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from vision_robot.track.running_median import RunningMedian
from vision_robot.types import Array, UInt8

__all__ = ["BackgroundModel", "Strip"]

STRIPS = 12


@dataclass
class Strip:
    """Some rows, their running median and when it takes its next sample."""

    rows: slice
    median: RunningMedian
    due_s: float = -np.inf


class BackgroundModel:
    """Running medians of all strips; `image` is the background, always up to date."""

    def __init__(self, shape: tuple[int, ...], window: int, span_s: float):
        """For frames of this shape; `window` samples are spread over `span_s` seconds (0: every frame)."""
        self.image = np.zeros(shape, dtype=np.uint8)
        self._window, self._span_s = window, span_s
        edges = np.linspace(0, shape[0], min(STRIPS, shape[0]) + 1).astype(int)
        self.strips = []
        for top, bottom in pairwise(edges.tolist()):
            out = self.image[top:bottom].reshape(-1)
            self.strips.append(Strip(slice(top, bottom), RunningMedian(len(out), window, out)))

    @property
    def count(self) -> int:
        """Samples in the windows, of the strip that has fewest."""
        return min(strip.median.count for strip in self.strips)

    def due(self, time_s: float) -> list[Strip]:
        """The strips that are to take a sample now."""
        return [strip for strip in self.strips if time_s >= strip.due_s]

    def take(self, strip: Strip, samples: UInt8[Array, "..."], time_s: float) -> None:
        """One more sample for a strip's rows."""
        first = strip.median.count == 0
        strip.median.push(np.ascontiguousarray(samples).reshape(-1))
        # While there are few samples they come faster: a camera just switched on has no past.
        filled = min(2 * strip.median.count / self._window, 1.0)
        step = self._span_s / self._window * filled
        share = (self.strips.index(strip) + 1) / len(self.strips)
        if first:
            strip.due_s = time_s + step * share
        else:
            # From when it was due, not from when a frame came: the strips stay apart.
            strip.due_s += step
            if strip.due_s < time_s:
                strip.due_s = time_s + step * share

    def restart(self, where: Array, frame: UInt8[Array, "..."]) -> None:
        """Forget what was behind the pixels of a (height, width) mask: they are as the frame shows them."""
        for strip in self.strips:
            chosen = where[strip.rows]
            if chosen.any():
                channels = frame[strip.rows].reshape(chosen.size, -1)
                at = np.flatnonzero(chosen.reshape(-1))
                flat = (at[:, None] * channels.shape[1] + np.arange(channels.shape[1])).ravel()
                strip.median.restart(flat, channels[at].ravel())

    def clear(self) -> None:
        """Forget everything."""
        for strip in self.strips:
            strip.median.clear()
            strip.due_s = -np.inf
