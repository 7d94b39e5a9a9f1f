"""Masks as runs: stretches of one label along a row, from which every moment has a closed form."""

from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.types import Array, Int, UInt8

__all__ = ["Runs"]


@dataclass(frozen=True)
class Runs:
    """Runs in the order of the rows; run i covers the pixels first[i] <= u < stop[i] of row v[i]."""

    label: Int[Array, "r"]
    """Which blob, from 1."""
    v: Int[Array, "r"]
    first: Int[Array, "r"]
    stop: Int[Array, "r"]
    count: int
    """How many blobs there are; labels without a run are counted too."""

    def __len__(self) -> int:
        return len(self.label)

    @classmethod
    def of_mask(cls, mask: UInt8[Array, "height width"]) -> "Runs":
        """Runs of what is not 0, labelled by 8-connected pieces."""
        height, width = mask.shape
        count, labels = cv2.connectedComponentsWithAlgorithm(mask, 8, cv2.CV_32S, cv2.CCL_BBDT)
        inside = mask.view(bool)  # numpy tells any byte but 0 for true
        # One more column, so that a run ends before the next row begins.
        change = np.empty((height, width + 1), dtype=bool)
        np.not_equal(inside[:, 1:], inside[:, :-1], out=change[:, 1:-1])
        change[:, 0], change[:, -1] = inside[:, 0], inside[:, -1]
        at = np.flatnonzero(change)
        v, first = np.divmod(at[::2], width + 1)
        return cls(labels[v, first].astype(np.int64), v, first, first + at[1::2] - at[::2], count - 1)

    @classmethod
    def of_labels(cls, labels: Int[Array, "height width"]) -> "Runs":
        """Runs of a picture whose pixels tell their blob's number, 0 for none."""
        height, width = labels.shape
        change = np.empty((height, width), dtype=bool)
        np.not_equal(labels[:, 1:], labels[:, :-1], out=change[:, 1:])
        change[:, 0] = True
        at = np.flatnonzero(change)
        label = labels.ravel()[at].astype(np.int64)
        length = np.diff(at, append=height * width)
        v, first = np.divmod(at, width)
        kept = label > 0
        return cls(label[kept], v[kept], first[kept], (first + length)[kept], int(label.max(initial=0)))

    def pixels(self) -> tuple[Int[Array, "k"], Int[Array, "k"], Int[Array, "k"]]:
        """Label, u and v of every pixel."""
        length = self.stop - self.first
        before = np.cumsum(length) - length
        u = np.arange(int(length.sum())) + np.repeat(self.first - before, length)
        return np.repeat(self.label, length), u, np.repeat(self.v, length)

    def moved(self, left: int, top: int) -> "Runs":
        """The same in a larger picture, whose corner lies so far to the left and above."""
        return Runs(self.label, self.v + top, self.first + left, self.stop + left, self.count)

    def painted(self, values: Array, shape: tuple[int, int]) -> Array:
        """A picture in which each pixel of blob i has values[i - 1], and 0 where no blob is."""
        picture = np.zeros(shape, dtype=values.dtype)
        label, u, v = self.pixels()
        picture[v, u] = values[label - 1]
        return picture

    def boxes(self) -> tuple[Int[Array, "n"], Int[Array, "n 4"]]:
        """Labels that have a run, and (first u, first v, last u + 1, last v + 1) of each."""
        order = np.argsort(self.label, kind="stable")
        label, v = self.label[order], self.v[order]
        start = np.flatnonzero(np.diff(label, prepend=0))
        if not len(start):
            return start, np.zeros((0, 4), dtype=np.int64)
        box = (
            np.minimum.reduceat(self.first[order], start),
            v[start],
            np.maximum.reduceat(self.stop[order], start),
            np.maximum.reduceat(v, start) + 1,
        )
        return label[start], np.stack(box, axis=1)
