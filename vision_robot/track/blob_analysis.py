"""Blob analysis: every connected piece of a mask as a row of numbers, in one pass.

What MATLAB's and scikit-image's ``regionprops`` tell: area, centroid, box, axes, orientation, and from
them eccentricity and extent (`Blobs.eccentricity`, `Blobs.extent`); solidity where it is asked for.
"""

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.track.blobs import Blobs
from vision_robot.track.moments import Moments, ellipses
from vision_robot.track.runs import Runs
from vision_robot.track.solidity import hull_areas
from vision_robot.types import Array, Float, Int

__all__ = ["AXES", "analyse", "analyse_runs"]

AXES = ("skimage", "matlab")
"""Conventions of axis lengths: second moments of pixel centres alone, or of square pixels."""


def analyse(
    mask: Array,
    weight: Array | None = None,
    *,
    axes: str = "skimage",
    solidity: bool = False,
    min_area_px: float = 0,
    kind: int = 0,
) -> Blobs:
    """The blobs of a picture, by rising label, which is the order of their first pixels.

    Args:
        mask: (height, width). Booleans or bytes: the 8-connected pieces of what is not 0. Wider
            integers: labels, one number for each blob, 0 for background.
        weight: Weight of each pixel, of the same shape: grey levels or coverage, for centroids and
            ellipses beyond the pixel grid. `area_px` is then the sum of weights.
        axes: "skimage" or "matlab", which adds 1/12 px² to second moments (see `ellipses`).
        solidity: Also tell area over area of the convex hull, as `extra["solidity"]`; costs time.
        min_area_px: Leave out blobs of less area than this (pixels, whatever their weights).
        kind: What to write into `Blobs.kind`.
    """
    mask = np.asarray(mask)
    if mask.ndim != 2:
        raise BadParameter("shape of the mask", mask.shape, "(height, width)")
    if weight is not None and np.shape(weight) != mask.shape:
        raise BadParameter("shape of the weight", np.shape(weight), f"{mask.shape}, as the mask's")
    if mask.dtype.itemsize == 1:
        runs = Runs.of_mask(np.ascontiguousarray(mask).view(np.uint8))
    else:
        runs = Runs.of_labels(mask)
    return analyse_runs(runs, weight, axes=axes, solidity=solidity, min_area_px=min_area_px, kind=kind)


def analyse_runs(
    runs: Runs,
    weight: Array | None = None,
    *,
    more: tuple[Int[Array, "k"], Int[Array, "k"], Int[Array, "k"], Float[Array, "k"]] | None = None,
    axes: str = "skimage",
    solidity: bool = False,
    min_area_px: float = 0,
    kind: int = 0,
) -> Blobs:
    """As `analyse`, from runs; `more` are (label, u, v, weight) of pixels to add, negative to take away."""
    if axes not in AXES:
        raise BadParameter("axes", axes, f"one of {', '.join(AXES)}")
    present, box = runs.boxes()
    area = np.bincount(runs.label, runs.stop - runs.first, minlength=runs.count + 1)[present]
    kept = area >= min_area_px
    present, box, area = present[kept], box[kept], area[kept]
    if not len(present):
        return Blobs.empty()
    row = np.full(runs.count + 1, -1)
    row[present] = np.arange(len(present))
    runs = _renumbered(runs, row)
    origin = np.rint((box[:, :2] + box[:, 2:]) / 2)
    moments = Moments.of_runs(runs, origin) if weight is None else _weighed(runs, weight, origin)
    if more is not None:
        at = row[more[0]]
        inside = at >= 0
        u, v, added = (column[inside] for column in more[1:])
        moments += Moments.of_pixels(at[inside], u, v, added, origin)
    lengths, yaw = ellipses(moments.covariance, pixels_are_squares=axes == "matlab")
    left_top = box[:, :2] - 0.5
    return Blobs(
        centroid_px=moments.centroid,
        box_px=np.concatenate([left_top, (box[:, 2:] - box[:, :2]).astype(float)], axis=1),
        area_px=moments.weight,
        axes_px=lengths,
        yaw_rad=yaw,
        kind=np.full(len(present), kind),
        extra={"solidity": area / hull_areas(runs, len(present))} if solidity else {},
    )


def _renumbered(runs: Runs, row: Int[Array, "m"]) -> Runs:
    """The runs of the blobs whose row is not below 0, labelled 1 + row."""
    at = row[runs.label]
    kept = at >= 0
    return Runs(at[kept] + 1, runs.v[kept], runs.first[kept], runs.stop[kept], int(row.max()) + 1)


def _weighed(runs: Runs, weight: Array, origin: Float[Array, "n 2"]) -> Moments:
    """Moments with each pixel's own weight."""
    label, u, v = runs.pixels()
    at = label - 1
    w = np.asarray(weight)[v, u].astype(float)
    if not (np.isfinite(w).all() and (np.bincount(at, w, minlength=len(origin)) > 0).all()):
        raise BadParameter("weight of a blob's pixels", "0 or not a number", "finite, with a positive sum")
    return Moments.of_pixels(at, u, v, w, origin)
