"""How alike two places in a picture are."""

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["box_overlap", "closeness"]


def box_overlap(boxes: Float[Array, "n 4"], others: Float[Array, "m 4"]) -> Float[Array, "n m"]:
    """Intersection over union of boxes (left, top, width, height); 0 for empty boxes, NaN for unknown."""
    a, b = boxes[:, None], others[None]
    low = np.maximum(a[..., :2], b[..., :2])
    high = np.minimum(a[..., :2] + a[..., 2:], b[..., :2] + b[..., 2:])
    common = np.maximum(high - low, 0).prod(axis=-1)
    union = a[..., 2:].prod(axis=-1) + b[..., 2:].prod(axis=-1) - common
    return np.divide(common, union, out=np.zeros_like(common), where=~(union <= 0))


def closeness(
    centroids_px: Float[Array, "n 2"], others_px: Float[Array, "m 2"], zero_px: float
) -> Float[Array, "n m"]:
    """``max(0, 1 - distance / zero_px)``, in [0, 1]: for objects whose boxes say little.

    The similarity of TrackEval's 2-D point benchmarks; 0.5 is half of `zero_px` away.
    """
    distance = np.linalg.norm(centroids_px[:, None] - others_px[None], axis=-1)
    return np.maximum(0, 1 - distance / zero_px)
