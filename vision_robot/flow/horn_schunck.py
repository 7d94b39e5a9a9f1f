"""Horn and Schunck (1981): by a number of sweeps, as is usual, and to the minimum, as is meant."""

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.flow.averaging import KERNEL
from vision_robot.flow.derivatives import Derivatives, cube
from vision_robot.flow.equations import FlowEquations
from vision_robot.flow.minimise import Minimum, minimise
from vision_robot.flow.multigrid import Multigrid
from vision_robot.types import Array, Float

__all__ = ["horn_schunck", "horn_schunck_sweeps"]

ALPHA = 15.0


def horn_schunck(
    first: Array,
    second: Array,
    *,
    alpha: float = ALPHA,
    tolerance_px: float = 0.01,
    start: Float[Array, "2 h w"] | None = None,
    grids: Multigrid | None = None,
) -> Minimum:
    """The flow between two grey pictures with the least energy, to within `tolerance_px` rms.

    For motions up to a pixel or two; `estimate_flow` takes larger ones. `start` and `grids` are as in
    `minimise`.
    """
    equations = FlowEquations(*pair(first, second), alpha)
    return minimise(equations, tolerance_px=tolerance_px, start=start, grids=grids)


def horn_schunck_sweeps(
    first: Array,
    second: Array,
    *,
    alpha: float = ALPHA,
    sweeps: int = 100,
    start: Float[Array, "2 h w"] | None = None,
) -> Float[Array, "2 h w"]:
    """Their iteration, word by word: a number of sweeps from `start`, else from zero.

    Kept as the reference of speed and of how far such sweeps stay from the minimum.
    """
    if sweeps < 1:
        raise BadParameter("sweeps", sweeps, "at least 1")
    x, y, t = pair(first, second)
    u, v = (np.zeros_like(x), np.zeros_like(x)) if start is None else start
    stiffness = alpha**2 + x * x + y * y
    for _ in range(sweeps):
        mean_u = cv2.filter2D(u, -1, KERNEL, borderType=cv2.BORDER_REPLICATE)
        mean_v = cv2.filter2D(v, -1, KERNEL, borderType=cv2.BORDER_REPLICATE)
        pull = (x * mean_u + y * mean_v + t) / stiffness
        u, v = mean_u - x * pull, mean_v - y * pull
    return np.stack([u, v])


def pair(first: Array, second: Array) -> Derivatives:
    """Derivatives of two pictures; raises BadParameter where their sizes differ."""
    if np.shape(first) != np.shape(second):
        raise BadParameter(
            "shape of the second picture", np.shape(second), f"{np.shape(first)}, as the first"
        )
    return cube(first, second)
