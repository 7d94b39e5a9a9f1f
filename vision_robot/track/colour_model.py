"""Which colours are an object's and which the background's: a table over the cube of colours.

The cube of blue, green and red is divided into 32 steps a side. Pixels of each object and of the background
are counted in it; a colour is an object's where most of the pixels that have it, or nearly it, are. A
pixel is then classified by one look into the table, whatever shape the object's region of the cube has.
"""

from collections.abc import Sequence

import cv2
import numpy as np

from vision_robot.track.gain import gain_tables
from vision_robot.types import Array, Float, Image, Int, UInt8

__all__ = ["ColourModel", "cube_colours"]

STEPS = 32
CELLS = STEPS**3

SHADES = ((0.7, 0.1), (0.85, 0.4), (1.0, 1.0), (1.15, 0.4))
"""The same paint in other light: factor on its colour, and weight of having seen it so."""

UNKNOWN = 0.02
"""Share of an object's largest count below which a colour near it is not its own."""

KEPT = 0.3
"""Weight of what was learned first, when learning goes on: a model cannot wander off."""

DENSE = 0.25
"""Share of candidates from which on all pixels are looked up."""


class ColourModel:
    """Counts of colours for some objects and the background, and the table made from them."""

    def __init__(self, kinds: int, tolerance: float):
        """For `kinds` objects; `tolerance` is how far colours spread around those seen [levels]."""
        self.kinds = kinds
        self._kernel = _gauss(tolerance / (256 / STEPS))
        self._first = np.zeros((kinds + 1, CELLS))  # the last is the background
        self._later = np.zeros((kinds + 1, CELLS))
        self.table: Array = np.zeros(CELLS, dtype=np.uint8)
        self._likely: Array = self.table
        self._gains = np.ones(3)

    def learn(self, objects: Sequence[UInt8[Array, "_ 3"]], background: UInt8[Array, "k 3"]) -> None:
        """From pixels of each object and of everything else."""
        for kind, colours in enumerate(objects):
            for factor, weight in SHADES:
                shade = np.clip(factor * colours.astype(np.float32), 0, 255).astype(np.uint8)
                self._first[kind] += weight * _counted(shade)
        self._first[-1] += _counted(background)
        self._later[:] = self._first
        self._rebuild()

    def adopt(self, table: UInt8[Array, "cells"]) -> None:
        """Take a table as it is, before any pixel has been seen."""
        self.table = self._likely = table
        self._index()

    def adapt(
        self, objects: Sequence[UInt8[Array, "_ 3"]], background: UInt8[Array, "k 3"], rate: float
    ) -> None:
        """Move the counts by `rate` towards those of new pixels; objects without any stay."""
        for kind, colours in enumerate([*objects, background]):
            new = _counted(colours)
            if new.sum() > 0:
                scaled = new * (self._first[kind].sum() / new.sum())
                self._later[kind] += rate * (scaled - self._later[kind])
        self._rebuild()

    def light(self, gains: Float[Array, "3"]) -> None:
        """The light has changed: every colour looks multiplied by these."""
        self._gains = np.asarray(gains, dtype=float)
        self._index()

    def classify(self, frame: Image) -> UInt8[Array, "height width"]:
        """0 for background, 1 + kind for an object, at every pixel."""
        mask = np.zeros(frame.shape[:2], dtype=np.uint8)
        possible = cv2.inRange(cv2.LUT(frame, self._possible), (1, 1, 1), (255, 255, 255))
        at = np.flatnonzero(possible.view(bool))
        if len(at) > DENSE * mask.size:
            parts = np.asarray(cv2.LUT(frame, self._parts), dtype=np.uint16)
            index = parts[..., 0] + parts[..., 1]
            index += parts[..., 2]
            return self.table.take(index)
        if len(at):
            colours = frame.reshape(-1, 3)[at]
            mask.ravel()[at] = self.table[self._index_of(colours)]
        return mask

    def grown(
        self, sure: UInt8[Array, "height width"], frame: Image, reach_px: int
    ) -> UInt8[Array, "height width"]:
        """The classes with pixels taken in that lie near sure ones, touch them, and are likelier than not."""
        near = cv2.dilate(sure, np.ones((2 * reach_px + 1,) * 2, np.uint8))
        at = np.flatnonzero((near > 0) & (sure == 0))
        if not len(at):
            return sure
        grown = sure.copy()
        kinds = self._likely[self._index_of(frame.reshape(-1, 3)[at])]
        grown.ravel()[at] = np.where(kinds == near.ravel()[at], kinds, 0)
        return grown

    def kind_of(self, colours: UInt8[Array, "k 3"]) -> UInt8[Array, "k"]:
        """0 or 1 + kind for single colours in the light now."""
        return self.table[self._index_of(colours)]

    def _index_of(self, colours: UInt8[Array, "k 3"]) -> Int[Array, "k"]:
        b, g, r = (self._parts[0, :, i][colours[:, i]].astype(np.intp) for i in range(3))
        return b + g + r

    def _rebuild(self) -> None:
        counts = KEPT * self._first + (1 - KEPT) * self._later
        smooth = np.stack([self._smoothed(one) for one in counts])
        own = smooth[:-1]
        best = own.argmax(axis=0)
        most = np.take_along_axis(own, best[None], axis=0)[0]
        known = most > UNKNOWN * own.max(axis=1)[best]
        self.table = np.where(known & (most > smooth[-1]), best + 1, 0).astype(np.uint8)
        # How rare objects are counts no more where an object is: there colours are weighed as shares.
        share = most / np.maximum(counts[:-1].sum(axis=1)[best], 1)
        likely = known & (share > smooth[-1] / max(counts[-1].sum(), 1))
        self._likely = np.where(likely, best + 1, self.table).astype(np.uint8)
        self._index()

    def _smoothed(self, counts: Float[Array, "cells"]) -> Float[Array, "cells"]:
        cube = counts.reshape(STEPS, STEPS, STEPS)
        reach = len(self._kernel) // 2
        for axis in range(3):
            padded = np.pad(cube, [(reach, reach) if i == axis else (0, 0) for i in range(3)])
            slices = (np.take(padded, range(k, k + STEPS), axis=axis) for k in range(len(self._kernel)))
            cube = sum(w * part for w, part in zip(self._kernel, slices, strict=True))
        return np.asarray(cube).ravel()

    def _index(self) -> None:
        """Tables for cv2.LUT: each channel's part of a cell's number, and which levels are possible."""
        step = gain_tables(1 / self._gains)[0] // (256 // STEPS)
        weights = np.array([STEPS * STEPS, STEPS, 1], dtype=np.uint16)
        self._parts = (step.astype(np.uint16) * weights)[None]
        cube = (self.table > 0).reshape(STEPS, STEPS, STEPS)
        possible = np.empty((256, 3), dtype=np.uint8)
        for channel in range(3):
            others = tuple(axis for axis in range(3) if axis != channel)
            possible[:, channel] = np.asarray(cube.any(axis=others))[step[:, channel]]
        self._possible = possible[None]


def cube_colours() -> UInt8[Array, "cells 3"]:
    """The middle colour of every cell, in the order of the table."""
    middle = ((np.arange(STEPS) + 0.5) * (256 / STEPS)).astype(np.uint8)
    return np.stack(np.meshgrid(middle, middle, middle, indexing="ij"), axis=-1).reshape(-1, 3)


def _counted(colours: UInt8[Array, "k 3"]) -> Float[Array, "cells"]:
    step = colours.astype(np.intp) // (256 // STEPS)
    cell = (step[:, 0] * STEPS + step[:, 1]) * STEPS + step[:, 2]
    return np.bincount(cell, minlength=CELLS).astype(float)


def _gauss(sigma: float) -> Float[Array, "k"]:
    reach = max(1, int(np.ceil(2.5 * sigma)))
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / max(sigma, 1e-3)) ** 2)
    return weights / weights.sum()
