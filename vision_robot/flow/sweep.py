"""A Jacobi sweep of  J w + c (d w − w̄) = b, where d is 1 unless there are bonds (see `averaging`).

With M = (J + c d)⁻¹ for every pixel it is  w' = M c w̄ + M b. What is left to be solved after it,
b − J w' − c (d w' − w̄'), is c times the average of w' − w: no product with J is needed.
"""

import cv2
import numpy as np

from vision_robot.flow.averaging import averaged
from vision_robot.types import Array, Float

__all__ = ["left_over", "settled", "swept"]


def settled(inverse: Float[Array, "3 h w"], pull: Float[Array, "2 h w"]) -> Float[Array, "2 h w"]:
    """M b, pixel by pixel: where a sweep from zero ends. M is symmetric, as (xx, xy, yy)."""
    xx, xy, yy = inverse
    out = np.empty_like(pull)
    cv2.multiply(xx, pull[0], dst=out[0])
    cv2.accumulateProduct(xy, pull[1], out[0])
    cv2.multiply(yy, pull[1], dst=out[1])
    cv2.accumulateProduct(xy, pull[0], out[1])
    return out


def swept(
    flow: Float[Array, "2 h w"],
    inverse: Float[Array, "3 h w"],
    into: Float[Array, "2 h w"],
    kernel: Float[Array, "3 3"],
    bond: Float[Array, "h w"] | None,
) -> Float[Array, "2 h w"]:
    """The flow after one sweep, written into `into`, which holds M b before; `kernel` averages, times c."""
    xx, xy, yy = inverse
    u, v = averaged(flow, kernel, bond)
    cv2.accumulateProduct(xx, u, into[0])
    cv2.accumulateProduct(xy, v, into[0])
    cv2.accumulateProduct(xy, u, into[1])
    cv2.accumulateProduct(yy, v, into[1])
    return into


def left_over(
    after: Float[Array, "2 h w"],
    before: Float[Array, "2 h w"],
    kernel: Float[Array, "3 3"],
    bond: Float[Array, "h w"] | None,
) -> Float[Array, "2 h w"]:
    """What is left to be solved after the sweep that led from `before` to `after`; overwrites `before`."""
    cv2.subtract(after[0], before[0], dst=before[0])
    cv2.subtract(after[1], before[1], dst=before[1])
    return averaged(before, kernel, bond)
