"""Multigrid: the flow's equations on a pyramid of grids, each solving for what is smooth on the finer one."""

import cv2
import numpy as np

from vision_robot.flow.averaging import averaged, binding
from vision_robot.flow.equations import FlowEquations
from vision_robot.flow.finest import Finest
from vision_robot.flow.grids import coarse_shape
from vision_robot.flow.level import Level
from vision_robot.types import Array, Float

__all__ = ["Multigrid"]

COARSEST = 48
"""Pixels of a grid that is solved directly."""

SWEEPS = 2
"""Jacobi sweeps of a cycle on the finest grid: one takes 0.8 of the time and contracts by 0.3, not 0.2."""


class Multigrid:
    """Grids for pictures of one size. `take` new equations as often as wanted: the memory is used again."""

    def __init__(self, shape: tuple[int, int], dtype: type = np.float32):
        self._finest = Finest(shape, dtype)
        self._levels: list[Level] = []
        shape, smoothness = coarse_shape(shape), 1 / 4
        while shape[0] * shape[1] > COARSEST:
            self._levels.append(Level(shape, smoothness, dtype))
            shape, smoothness = coarse_shape(shape), smoothness / 4
        self._smoothness = smoothness
        self._tensor, self._pull = np.empty((3, *shape), dtype), np.empty((2, *shape), dtype)

    @property
    def flow(self) -> Float[Array, "2 h w"]:
        """The flow so far; overwritten by the next improvement but one."""
        return self._finest.flow

    def take(self, equations: FlowEquations) -> None:
        """Take the equations and make those of all coarser grids."""
        below = [(level.tensor, level.pull) for level in self._levels] + [(self._tensor, self._pull)]
        self._finest.prepare(equations, *below[0])
        bond = equations.bond
        for level, coarse in zip(self._levels, below[1:], strict=True):
            level.bond = bond = _coarse_bond(bond, level.shape)
            level.prepare(*coarse)
        self._inverse = _inverse(
            self._tensor, self._smoothness, _coarse_bond(bond, (self._tensor.shape[1], self._tensor.shape[2]))
        )

    def start(self) -> None:
        """A first flow: solved on the coarsest grid, then interpolated and improved on each finer one."""
        flow = self._direct(self._pull)
        for k in range(len(self._levels) - 1, -1, -1):
            level = self._levels[k]
            flow = level.sweep(flow)
            cv2.add(flow, self._cycle(k, level.rest), dst=flow)
        self._finest.begin(flow, SWEEPS)

    def start_from(self, flow: Float[Array, "2 h w"]) -> None:
        """A first flow that is given."""
        self._finest.begin_from(flow)

    def correction(self) -> Float[Array, "2 hc wc"]:
        """What the coarser grids make of what the flow leaves to be solved: nearly minimiser − flow."""
        return self._cycle(0, self._finest.rest)

    def improve(self, correction: Float[Array, "2 hc wc"]) -> None:
        """Apply it, and sweep."""
        self._finest.improve(correction, SWEEPS)

    def _cycle(self, k: int, pull: Float[Array, "2 h w"]) -> Float[Array, "2 h w"]:
        """One V-cycle from zero on level k: nearly the solution for this right-hand side."""
        if k == len(self._levels):
            return self._direct(pull)
        level = self._levels[k]
        return level.ascend(pull, self._cycle(k + 1, level.descend(pull)))

    def _direct(self, pull: Float[Array, "2 h w"]) -> Float[Array, "2 h w"]:
        return (self._inverse @ pull.ravel()).reshape(pull.shape)


def _coarse_bond(bond: Float[Array, "h w"] | None, shape: tuple[int, int]) -> Float[Array, "hc wc"] | None:
    return None if bond is None else cv2.resize(bond, shape[::-1], interpolation=cv2.INTER_AREA)


def _inverse(
    tensor: Float[Array, "3 h w"], c: float, bond: Float[Array, "h w"] | None
) -> Float[Array, "n n"]:
    """Inverse of J + c (d − mean) of a small grid; what nothing holds is held to zero, very softly."""
    height, width = tensor.shape[1:]
    n = height * width
    bond = None if bond is None else bond.astype(float)
    smooth = averaged(np.eye(n).reshape(n, height, width).copy(), bond=bond).reshape(n, n)
    firm = np.ones(n) if bond is None else binding(bond).ravel()
    matrix = np.zeros((2, n, 2, n))
    matrix[0, :, 0] = matrix[1, :, 1] = c * (np.diag(firm) - smooth)
    xx, xy, yy = tensor.reshape(3, n).astype(float)
    at = np.arange(n)
    matrix[0, at, 0, at] += xx + 1e-6 * c
    matrix[1, at, 1, at] += yy + 1e-6 * c
    matrix[0, at, 1, at] += xy
    matrix[1, at, 0, at] += xy
    return np.linalg.inv(matrix.reshape(2 * n, 2 * n)).astype(tensor.dtype)
