"""What is shown to those that must be shown an object: places in the first frame, from the truth."""

from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.dataset import Dataset
from vision_robot.errors import BadDataset
from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float, Image, Int

__all__ = ["Examples", "examples_of"]

HIDDEN, CUT = 0.3, 0.5
"""Nobody points at what is hidden or outside of the picture by more than these shares, if there is more."""

ALIKE_LEVELS = 40.0
"""Colours nearer than this are one colour: it is shown once."""

MOST_COLOURS = 8


@dataclass(frozen=True)
class Examples:
    """Objects of one frame, the largest first."""

    frame: int
    boxes_px: Float[Array, "k 4"]
    points_px: Float[Array, "c 2"]
    """One point for each different colour, on an object of that colour."""


def examples_of(data: Dataset) -> Examples:
    """The objects of the first frame in which one is well seen. Raises BadDataset where there is none."""
    truth = _well_seen(data.truth)
    if not len(truth):
        raise BadDataset(data.path, "its truth holds no object")
    first = int(truth.frame.min())
    rows = truth.rows(np.flatnonzero(truth.frame == first))
    rows = rows.rows(np.argsort(-rows.box_px[:, 2:].prod(axis=1), kind="stable"))
    image, ids = data.frame(first).image, data.masks(first)
    points = [_inside(rows, i, ids, image) for i in range(len(rows))]
    return Examples(first, rows.box_px, np.array(_of_different_colours(points, image)))


def _well_seen(truth: Tracks) -> Tracks:
    placed = np.isfinite(truth.box_px).all(axis=1) & np.isfinite(truth.centroid_px).all(axis=1)
    clear = placed.copy()
    for name, most in (("occluded", HIDDEN), ("truncated", CUT)):
        if name in truth.extra:
            clear &= truth.extra[name] <= most
    return truth.rows(np.flatnonzero(clear if clear.any() else placed))


def _inside(rows: Tracks, i: int, ids: Int[Array, "h w"] | None, image: Image) -> tuple[int, int]:
    """The pixel of an object farthest from its border; without masks the middle of its box."""
    if ids is not None and (ids == rows.id[i]).any():
        mask = np.pad((ids == rows.id[i]).astype(np.uint8), 1)
        v, u = np.unravel_index(cv2.distanceTransform(mask, cv2.DIST_L2, 5).argmax(), mask.shape)
        return int(u) - 1, int(v) - 1
    middle = rows.box_px[i, :2] + rows.box_px[i, 2:] / 2
    u, v = np.clip(np.rint(middle), 0, (image.shape[1] - 1, image.shape[0] - 1))
    return int(u), int(v)


def _of_different_colours(points: list[tuple[int, int]], image: Image) -> list[tuple[float, float]]:
    smooth = cv2.medianBlur(image, 5).astype(float)
    kept: list[tuple[float, float]] = []
    colours: list[Array] = []
    for u, v in points:
        colour = smooth[v, u]
        if all(np.linalg.norm(colour - other) > ALIKE_LEVELS for other in colours):
            kept.append((float(u), float(v)))
            colours.append(colour)
    return kept[:MOST_COLOURS]
