"""The flow of least energy, and how far from it one is."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.flow.equations import FlowEquations
from vision_robot.flow.multigrid import Multigrid
from vision_robot.types import Array, Float

__all__ = ["Minimum", "minimise"]

CAUTION = 1.5
"""What coarse grids make of the distance is between 0.8 and 1.3 times the truth where it matters."""


@dataclass(frozen=True)
class Minimum:
    """A flow and how far it is from the one that minimises its energy."""

    flow: Float[Array, "2 h w"]
    """(du, dv) [px]."""
    distance_px: float
    """Estimated |flow − minimiser|, rms over the picture; rather too large than too small."""
    cycles: int


def minimise(
    equations: FlowEquations,
    *,
    tolerance_px: float = 0.01,
    start: Float[Array, "2 h w"] | None = None,
    grids: Multigrid | None = None,
    most_cycles: int = 30,
) -> Minimum:
    """Solve the equations until the flow is within `tolerance_px` (rms) of their solution.

    The distance is the length of what the coarse grids make of the residual, which is nearly minimiser −
    flow once sweeps have taken away what is rough; being nearly that it is also the next cycle's
    correction, and costs little.

    Args:
        equations: What to solve.
        tolerance_px: Stop at this distance.
        start: A flow near the solution, such as the last frame's; none starts from coarse grids.
        grids: Memory of an earlier call with pictures of the same size, taken over.
        most_cycles: Stop after so many cycles, whatever the distance.
    """
    if min(equations.shape) < 2:
        raise BadParameter("size of a picture", equations.shape[::-1], "at least 2x2 px")
    lent = grids is not None
    grids = grids or Multigrid(equations.shape, equations.x.dtype.type)
    grids.take(equations)
    if start is None:
        grids.start()
    else:
        grids.start_from(start)
    cycles = 0
    while True:
        correction = grids.correction()
        distance = CAUTION * float(np.sqrt(2 * np.mean(np.square(correction))))
        if distance <= tolerance_px or cycles >= most_cycles:
            return Minimum(grids.flow.copy() if lent else grids.flow, distance, cycles)
        grids.improve(correction)
        cycles += 1
