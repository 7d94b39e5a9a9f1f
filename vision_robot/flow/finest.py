"""The finest grid, where the time goes: all that is done to it in a cycle is one pass over memory."""

import cv2
import numpy as np

from vision_robot.flow.averaging import KERNEL, binding
from vision_robot.flow.equations import FlowEquations
from vision_robot.flow.grids import coarse_rows, coarse_shape, grown_rows, shrink
from vision_robot.flow.level import STIFFNESS
from vision_robot.flow.strips import Strip, strips
from vision_robot.flow.sweep import left_over, swept
from vision_robot.types import Array, Float

__all__ = ["Finest"]


class Finest:
    """A grid of (height, width) pixels with the equations of `FlowEquations`, and memory to work in."""

    def __init__(self, shape: tuple[int, int], dtype: type):
        self.shape = shape
        self.kernel = KERNEL.astype(dtype)
        self.flow = np.empty((2, *shape), dtype)
        self.rest = np.empty((2, *coarse_shape(shape)), dtype)
        """What the flow leaves to be solved, on the next coarser grid."""
        self.bond: Float[Array, "h w"] | None = None
        self._inverse = np.empty((3, *shape), dtype)
        self._settled = np.empty((2, *shape), dtype)
        self._next = np.empty((2, *shape), dtype)

    def prepare(
        self, equations: FlowEquations, tensor: Float[Array, "3 hc wc"], pull: Float[Array, "2 hc wc"]
    ) -> None:
        """Take the equations, and write those of the next coarser grid, as `Level.prepare` does."""
        scale = 1 / equations.alpha**2
        self.bond = equations.bond
        firm = None if self.bond is None else binding(self.bond)
        for strip in strips(self.shape):
            rows = strip.rows
            x, y, t = equations.x[rows], equations.y[rows], equations.t[rows]
            inverse, end = self._inverse[:, rows], self._settled[:, rows]
            soft = np.empty((5, *x.shape), x.dtype)
            xx, xy, yy, bx, by = soft
            for plane, (a, b, sign) in zip(
                soft, ((x, x, 1), (x, y, 1), (y, y, 1), (x, t, -1), (y, t, -1)), strict=True
            ):
                cv2.multiply(a, b, dst=plane, scale=sign * scale)
            # With one channel det J = 0; (J + d)⁻¹ is (adj J + d) / d (d + trace J), and b becomes
            # b / (d + trace J).
            trace = cv2.add(xx, yy)
            d: Array | float = 1.0 if firm is None else firm[rows]
            own = np.reciprocal(trace + d)
            cv2.multiply(bx, own, dst=end[0])
            cv2.multiply(by, own, dst=end[1])
            if firm is not None:
                own /= d
            cv2.multiply(yy + d, own, dst=inverse[0])
            cv2.multiply(xy, own, dst=inverse[1], scale=-1)
            cv2.multiply(xx + d, own, dst=inverse[2])
            share = STIFFNESS * d / (trace + STIFFNESS * d)
            for plane in soft:
                cv2.multiply(plane, share, dst=plane)
            shrink(soft[:3], tensor[:, coarse_rows(strip)])
            shrink(soft[3:], pull[:, coarse_rows(strip)])

    def begin(self, coarse: Float[Array, "2 hc wc"], sweeps: int) -> None:
        """Forget the flow of before, and sweep from the coarse grid's; what is left goes into `rest`."""
        for strip in strips(self.shape, sweeps + 1):
            self._relax(strip, np.stack(grown_rows(coarse, self.shape, strip)), sweeps)
        self.flow, self._next = self._next, self.flow

    def begin_from(self, flow: Float[Array, "2 h w"]) -> None:
        """Forget the flow of before, and sweep once from a given one; what is left goes into `rest`."""
        for strip in strips(self.shape, 2):
            self._relax(strip, flow[:, strip.known].copy(), 1)
        self.flow, self._next = self._next, self.flow

    def improve(self, coarse: Float[Array, "2 hc wc"], sweeps: int) -> None:
        """Add the coarse grid's correction to the flow, and sweep; what is left goes into `rest`."""
        for strip in strips(self.shape, sweeps + 1):
            corrections = grown_rows(coarse, self.shape, strip)
            flow = np.empty((2, *corrections[0].shape), self.flow.dtype)
            for plane, correction, out in zip(self.flow[:, strip.known], corrections, flow, strict=True):
                cv2.add(plane, correction, dst=out)
            self._relax(strip, flow, sweeps)
        self.flow, self._next = self._next, self.flow

    def _relax(self, strip: Strip, flow: Float[Array, "2 r w"], sweeps: int) -> None:
        inverse, end = self._inverse[:, strip.known], self._settled[:, strip.known]
        bond = None if self.bond is None else self.bond[strip.known]
        before = flow
        for _ in range(sweeps):
            before, flow = flow, swept(flow, inverse, end.copy(), self.kernel, bond)
        self._next[:, strip.rows] = flow[:, strip.inner]
        left = left_over(flow, before, self.kernel, bond)
        shrink(left[:, strip.inner], self.rest[:, coarse_rows(strip)])
