"""Areas of convex hulls, counted in pixels as scikit-image counts them."""

from itertools import pairwise

import cv2
import numpy as np

from vision_robot.track.runs import Runs
from vision_robot.types import Array, Float

__all__ = ["hull_areas"]

ON_EDGE = 1e-9


def hull_areas(runs: Runs, count: int) -> Float[Array, "n"]:
    """Pixels whose centres lie in or on the convex hull of each of the blobs 1 to `count`.

    The hull is that of the middles of the pixels' four sides.
    """
    order = np.argsort(runs.label, kind="stable")
    label = runs.label[order]
    start = np.searchsorted(label, np.arange(1, count + 2))
    v, first, last = runs.v[order], runs.first[order], runs.stop[order] - 1
    return np.array([_hull_area(v[a:b], first[a:b], last[a:b]) for a, b in pairwise(start)])


def _hull_area(v: Array, first: Array, last: Array) -> float:
    # Twice the coordinates: the middles of sides are then whole numbers.
    left, right, row = 2 * first, 2 * last, 2 * v
    points = np.concatenate(
        [
            np.stack([u, y], axis=1)
            for u, y in (
                (left - 1, row),
                (right + 1, row),
                (left, row - 1),
                (right, row - 1),
                (left, row + 1),
                (right, row + 1),
            )
        ]
    ).astype(np.int32)
    hull = cv2.convexHull(points)[:, 0].astype(float)
    inside = np.arange(row.min(), row.max() + 1, 2)
    low, high = _crossings(hull, inside)
    counts = np.floor(high / 2 + ON_EDGE) - np.ceil(low / 2 - ON_EDGE) + 1
    return float(np.clip(counts, 0, None).sum())


def _crossings(hull: Float[Array, "k 2"], rows: Array) -> tuple[Float[Array, "r"], Float[Array, "r"]]:
    """Where each row enters and leaves a convex polygon; the rows lie inside its height."""
    a, b = hull, np.roll(hull, -1, axis=0)
    rise = (b[:, 1] - a[:, 1])[:, None]
    share = (rows[None, :] - a[:, 1:2]) / np.where(rise == 0, np.nan, rise)
    u = a[:, :1] + share * (b[:, 0] - a[:, 0])[:, None]
    u = np.where((share >= 0) & (share <= 1), u, np.nan)
    return np.nanmin(u, axis=0), np.nanmax(u, axis=0)
