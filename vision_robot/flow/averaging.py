"""Horn and Schunck's local average, and the smoothness that it stands for.

With w̄ the average of w over the eight neighbours (1/6 beside, 1/12 across the corner), Σ w·(w − w̄) is
half the sum of squared differences to the neighbours, weighted alike. Beyond the border the picture repeats
its last row, which keeps the average symmetric: there is one energy, and one minimiser.

Where pixels are bound to their neighbours more or less firmly, each difference counts by the mean of the
two pixels' bonds β, and w − w̄ becomes d w − w̄ with d = (β + β̄)/2 and the mean of β w̄ and of the average
of β w for w̄.
"""

import cv2
import numpy as np

from vision_robot.types import Array, Float

__all__ = ["KERNEL", "averaged", "binding"]

KERNEL = np.array([[1, 2, 1], [2, 0, 2], [1, 2, 1]], dtype=np.float32) / 12
"""Horn & Schunck (1981), section 9."""


def averaged(
    field: Float[Array, "k h w"],
    kernel: Float[Array, "3 3"] = KERNEL,
    bond: Float[Array, "h w"] | None = None,
) -> Float[Array, "k h w"]:
    """The average of each plane, with bonds where given; `kernel` may be a multiple of `KERNEL`."""
    out = np.empty_like(field)
    if bond is None:
        for plane, mean in zip(field, out, strict=True):
            cv2.filter2D(plane, -1, kernel, dst=mean, borderType=cv2.BORDER_REPLICATE)
        return out
    half = kernel / 2
    for plane, mean in zip(field, out, strict=True):
        cv2.filter2D(plane, -1, half, dst=mean, borderType=cv2.BORDER_REPLICATE)
        cv2.multiply(mean, bond, dst=mean)
        bound = cv2.filter2D(cv2.multiply(plane, bond), -1, half, borderType=cv2.BORDER_REPLICATE)
        cv2.add(mean, bound, dst=mean)
    return out


def binding(bond: Float[Array, "h w"]) -> Float[Array, "h w"]:
    """d: how firmly each pixel is bound to all its neighbours together."""
    return (bond + averaged(bond[None])[0]) / 2
