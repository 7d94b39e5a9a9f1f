"""The least area of a blob, chosen from the data: noise comes and goes, objects are there a frame later."""

import numpy as np

from vision_robot.track.blobs import Blobs
from vision_robot.types import Array, Bool, Float, Int

__all__ = ["AreaSieve"]

STEPS = 2
"""Classes of area for each doubling."""

CLASSES = 2 * 24
FORGET = 0.995
PERSISTENT = 0.85
"""Share of a class that must be seen again for it to count as objects."""

LEAST_PX = 6.0
"""Blobs below this are never objects: their ellipse means nothing."""

ENOUGH = 5.0


class AreaSieve:
    """Learns which areas persist from frame to frame, and leaves out those that do not."""

    def __init__(self, min_area_px: float | None = None):
        self._fixed = min_area_px
        self._seen = np.zeros(CLASSES)
        self._again = np.zeros(CLASSES)
        self._before = Blobs.empty()

    @property
    def min_area_px(self) -> float:
        """The least area now."""
        if self._fixed is not None:
            return self._fixed
        share = self._share()
        fleeting = np.flatnonzero((share < PERSISTENT) & (self._seen >= ENOUGH))
        # Large things may be fleeting too; what separates is a class above which all persist.
        lasting = np.flatnonzero((share >= PERSISTENT) & (self._seen >= ENOUGH))
        if not len(fleeting):
            return LEAST_PX
        top = fleeting[fleeting < lasting.max()].max(initial=-1) if len(lasting) else fleeting.max()
        return max(float(2 ** ((top + 1) / STEPS)), LEAST_PX)

    def accepts(self, blobs: Blobs) -> Bool[Array, "n"]:
        """Which blobs are large enough, having learned from them."""
        if self._fixed is None:
            self._learn(blobs)
        return blobs.area_px >= self.min_area_px

    def scores(self, blobs: Blobs) -> Float[Array, "n"]:
        """How many of a hundred blobs of such an area persist, as a share."""
        at = _class_of(blobs.area_px)
        return np.clip((self._again[at] + 1) / (self._seen[at] + 1), 0, 1)

    def _share(self) -> Float[Array, "classes"]:
        return self._again / np.maximum(self._seen, 1e-9)

    def _learn(self, blobs: Blobs) -> None:
        """Was each blob of the frame before seen again, about as large?

        No farther than its own length, or anywhere if it is the only one of about its size in both
        frames: chance does not bring one such blob to every frame, a fast object does.
        """
        before, self._before = self._before, blobs
        if not len(before):
            return
        self._seen *= FORGET
        self._again *= FORGET
        again = np.zeros(len(before))
        if len(blobs):
            du, dv = (
                np.subtract.outer(a, b)
                for a, b in zip(before.centroid_px.T, blobs.centroid_px.T, strict=True)
            )
            ratio = before.area_px[:, None] / np.maximum(blobs.area_px[None], 1e-9)
            alike = (ratio > 0.4) & (ratio < 2.5)
            near = du * du + dv * dv < np.maximum(before.axes_px[:, :1] ** 2, 4.0)
            only = (alike.sum(axis=1, keepdims=True) == 1) & (alike.sum(axis=0) == 1)
            again = (alike & (near | only)).any(axis=1).astype(float)
        at = _class_of(before.area_px)
        self._seen += np.bincount(at, minlength=CLASSES)
        self._again += np.bincount(at, again, minlength=CLASSES)


def _class_of(area_px: Float[Array, "n"]) -> Int[Array, "n"]:
    return np.clip(STEPS * np.log2(np.maximum(area_px, 1)), 0, CLASSES - 1).astype(int)
