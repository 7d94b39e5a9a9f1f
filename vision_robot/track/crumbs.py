"""Crumbs: small pieces beside a large one, which are of the same object."""

import cv2
import numpy as np

from vision_robot.track.runs import Runs
from vision_robot.types import Array, Bool, Float

__all__ = ["are_crumbs"]

SMALL = 0.1
"""Share of its neighbour's area below which a piece is a crumb."""

NEAR_PX = 5
"""How far apart they may lie."""


def are_crumbs(runs: Runs, area_px: Float[Array, "n"], shape: tuple[int, int]) -> Bool[Array, "n"]:
    """Which pieces lie beside another that is ten times as large, or more."""
    if runs.count < 2 or area_px.min() >= SMALL * area_px.max():
        return np.zeros(runs.count, dtype=bool)
    order = np.argsort(area_px, kind="stable")
    rank = np.empty(runs.count, dtype=np.uint16)
    rank[order] = np.arange(1, runs.count + 1)
    # The largest of all that are near wins the pixel.
    near = cv2.dilate(runs.painted(rank, shape), np.ones((2 * NEAR_PX + 1,) * 2, np.uint8))
    label, u, v = runs.pixels()
    beside = np.zeros(runs.count, dtype=np.int64)
    np.maximum.at(beside, label - 1, near[v, u].astype(np.int64))
    return area_px < SMALL * area_px[order[beside - 1]]
