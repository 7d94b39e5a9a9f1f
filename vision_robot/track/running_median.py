"""The exact median of the last samples of every pixel, kept up to date at the speed of memory.

For each pixel the window's samples below each of a few neighbouring grey levels are counted. A new sample
and the one it displaces change each count by at most one, so that one frame costs a fixed
number of byte operations and no sorting; the median is the highest level with at most half of the
samples below it. Where the median leaves the levels that are counted, which is rare, the counts of that pixel
are made anew from its window.
"""

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Int, UInt8

__all__ = ["RunningMedian"]

BAND = 8
"""Levels counted around the median: noise of 5 levels then leaves them in one pixel of 400 a frame."""

HIGHEST = 256 - BAND
"""Where the counted levels end at white."""

BLOCK = 65536
"""Samples worked on at a time: the counts of a block stay in the cache."""


class RunningMedian:
    """Median of the last `window` pushes of `size` samples each; with fewer pushes, of all.

    With an odd number of pushes it is ``numpy.median`` bit for bit, with an even number (while
    the window fills) the lower of the two middle samples.
    """

    def __init__(self, size: int, window: int, out: UInt8[Array, "size"] | None = None):
        """`out`, where given, is a contiguous array that will always hold the median."""
        if not (3 <= window <= 255 and window % 2):
            raise BadParameter("window of the median", window, "an odd number from 3 to 255")
        self.window = window
        self.median = np.zeros(size, dtype=np.uint8) if out is None else out
        self._ring = np.zeros((window, size), dtype=np.uint8)
        self._count = 0
        self._next = 0
        self._lowest = np.zeros(size, dtype=np.uint8)
        self._below = np.zeros((BAND, size), dtype=np.uint8)

    @property
    def count(self) -> int:
        """Samples of each pixel in the window."""
        return self._count

    @property
    def samples(self) -> UInt8[Array, "count size"]:
        """The samples in the window, in no particular order."""
        return self._ring[: self._count]

    def push(self, samples: UInt8[Array, "size"]) -> None:
        """Take in one sample of each pixel; the oldest leaves where the window is full."""
        full = self._count == self.window
        self._count = min(self._count + 1, self.window)
        for start in range(0, len(samples), BLOCK):
            block = slice(start, min(start + BLOCK, len(samples)))
            new, old = samples[block], self._ring[self._next, block]
            self._push(block, new, old if full else None)
        self._next = (self._next + 1) % self.window

    def clear(self) -> None:
        """Forget everything."""
        self._count = self._next = 0
        self._lowest[:], self._below[:] = 0, 0

    def restart(self, where: Int[Array, "k"], samples: UInt8[Array, "k"]) -> None:
        """Forget the past of some pixels: their windows are filled with one sample each."""
        self._ring[: self._count, where] = samples
        self._count_anew(where)

    def _push(self, block: slice, new: Array, old: Array | None) -> None:
        half = (self._count - 1) // 2
        level = self._lowest[block].copy()
        steps = np.zeros(len(new), dtype=np.uint8)
        true = np.empty(len(new), dtype=bool)
        one = true.view(np.uint8)
        for j in range(BAND):
            below = self._below[j, block]
            np.less(new, level, out=true)
            np.add(below, one, out=below)
            if old is not None:
                np.less(old, level, out=true)
                np.subtract(below, one, out=below)
            np.less_equal(below, half, out=true)
            np.add(steps, one, out=steps)
            np.add(level, 1, out=level)  # past 255 only where no sample is, and the last is not used
        self._ring[self._next, block] = new
        median = self.median[block]
        np.add(self._lowest[block], steps, out=median)
        np.subtract(median, 1, out=median)
        outside = np.flatnonzero((steps == 0) | (steps == BAND))
        # At the white end of the scale there are no levels beyond the last counted.
        outside = outside[(steps[outside] == 0) | (self._lowest[block][outside] < HIGHEST)]
        if len(outside):
            self._count_anew(block.start + outside)

    def _count_anew(self, where: Int[Array, "k"]) -> None:
        window = np.take(self._ring[: self._count], where, axis=1)
        half = (self._count - 1) // 2
        median = np.partition(window, half, axis=0)[half]
        lowest = np.clip(median.astype(np.int16) - (BAND - 1) // 2, 0, HIGHEST).astype(np.uint8)
        self.median[where], self._lowest[where] = median, lowest
        true = np.empty(window.shape, dtype=bool)
        for j in range(BAND):
            np.less(window, lowest + np.uint8(j), out=true)
            self._below[j, where] = np.add.reduce(true.view(np.uint8), axis=0, dtype=np.uint8)
