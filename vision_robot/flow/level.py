"""A coarse grid: its equations J w + c (d w − w̄) = b, sweeps, and the ways down and up."""

import cv2
import numpy as np

from vision_robot.flow.averaging import KERNEL, averaged, binding
from vision_robot.flow.grids import coarse_rows, coarse_shape, grown, grown_rows, shrink
from vision_robot.flow.strips import Strip, strips
from vision_robot.flow.sweep import left_over, settled, swept
from vision_robot.types import Array, Float

__all__ = ["STIFFNESS", "Level"]

STIFFNESS = 3.0
"""How stiff, in units of c, a pixel's data may count on the next coarser grid.

Where J is far stiffer than c a pixel keeps its own flow whatever the smooth flow around it does; all it can
do to its surroundings is to pull with at most c. So not J is averaged but what is left of it once the pixel
itself has given way, k J (J + k)⁻¹ with k of the order of c, and b likewise. Averaging J itself makes
coarse grids far too stiff along edges, and a cycle then contracts errors two to three times less. Between 2
and 4 it hardly matters.
"""


class Level:
    """A grid of (height, width) pixels between the finest and the coarsest, with memory to work in."""

    def __init__(self, shape: tuple[int, int], smoothness: float, dtype: type):
        self.shape = shape
        self.smoothness = smoothness
        self.kernel = (KERNEL * smoothness).astype(dtype)
        self.tensor = np.empty((3, *shape), dtype)
        self.pull = np.empty((2, *shape), dtype)
        """The equations' own right-hand side; a cycle is given the one of its residual."""
        self.bond: Float[Array, "h w"] | None = None
        self.rest = np.empty((2, *shape), dtype)
        self.coarse_rest = np.empty((2, *coarse_shape(shape)), dtype)
        self._inverse = np.empty((3, *shape), dtype)
        self._correction = np.empty((2, *shape), dtype)

    def prepare(self, tensor: Float[Array, "3 hc wc"], pull: Float[Array, "2 hc wc"]) -> None:
        """Once `tensor` and `pull` are set: invert, and write the equations of the next coarser grid."""
        firm = None if self.bond is None else binding(self.bond)
        for strip in strips(self.shape, crowd=2):
            c: Array | float = self.smoothness if firm is None else self.smoothness * firm[strip.rows]
            k = STIFFNESS * c
            xx, xy, yy = self.tensor[:, strip.rows]
            bx, by = self.pull[:, strip.rows]
            inverse = self._inverse[:, strip.rows]
            trace = xx + yy
            det = xx * yy
            det -= xy * xy
            own = np.reciprocal(det + c * trace + c * c)
            cv2.multiply(yy + c, own, dst=inverse[0])
            cv2.multiply(xy, own, dst=inverse[1], scale=-1)
            cv2.multiply(xx + c, own, dst=inverse[2])
            # k J (J + k)⁻¹ = (k J + det J) k / det(J + k), and the same of b.
            share = k / (det + k * trace + k * k)
            soft = np.empty((5, *xx.shape), xx.dtype)
            np.multiply(k * xx + det, share, out=soft[0])
            np.multiply(k * xy, share, out=soft[1])
            np.multiply(k * yy + det, share, out=soft[2])
            cv2.multiply((yy + k) * bx - xy * by, share, dst=soft[3])
            cv2.multiply((xx + k) * by - xy * bx, share, dst=soft[4])
            shrink(soft[:3], tensor[:, coarse_rows(strip)])
            shrink(soft[3:], pull[:, coarse_rows(strip)])

    def descend(self, pull: Float[Array, "2 h w"]) -> Float[Array, "2 hc wc"]:
        """One sweep from zero; what is left for the coarser grid."""
        for strip in strips(self.shape, 1):
            end = settled(self._inverse[:, strip.known], pull[:, strip.known])
            left = averaged(end, self.kernel, self._bond(strip))
            shrink(left[:, strip.inner], self.coarse_rest[:, coarse_rows(strip)])
        return self.coarse_rest

    def ascend(self, pull: Float[Array, "2 h w"], coarse: Float[Array, "2 hc wc"]) -> Float[Array, "2 h w"]:
        """The sweep of `descend`, the coarse grid's correction, and one sweep after it."""
        for strip in strips(self.shape, 1):
            inverse = self._inverse[:, strip.known]
            after = settled(inverse, pull[:, strip.known])
            corrections = grown_rows(coarse, self.shape, strip)
            before = np.empty_like(after)
            for plane, correction, out in zip(after, corrections, before, strict=True):
                cv2.add(plane, correction, dst=out)
            after = swept(before, inverse, after, self.kernel, self._bond(strip))
            self._correction[:, strip.rows] = after[:, strip.inner]
        return self._correction

    def sweep(self, coarse: Float[Array, "2 hc wc"]) -> Float[Array, "2 h w"]:
        """One sweep from the coarse grid's flow; what is left goes into `rest`."""
        before = grown(coarse, self.shape)
        after = swept(before, self._inverse, settled(self._inverse, self.pull), self.kernel, self.bond)
        self.rest[:] = left_over(after, before, self.kernel, self.bond)
        return after

    def _bond(self, strip: Strip) -> Float[Array, "r w"] | None:
        return None if self.bond is None else self.bond[strip.known]
