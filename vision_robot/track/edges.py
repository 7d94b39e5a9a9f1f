"""Blobs beyond the pixel grid: at its edge a pixel shows a mixture of object and background.

How much of a pixel the object covers is the mixture's share (alpha), read off between the object's own colour
nearby and the background's at that pixel. Summed instead of counted, it gives areas, centroids and ellipses
that do not depend on where the threshold fell.
"""

import cv2
import numpy as np

from vision_robot.track.blob_analysis import analyse_runs
from vision_robot.track.blobs import Blobs
from vision_robot.track.runs import Runs
from vision_robot.types import Array, Bool, Float, Image, Int, UInt8, UInt16

__all__ = ["analyse_edges"]

REACH = 4
"""Farthest neighbour asked for its colour [px]."""

INSIDE, OUTSIDE = 2, 2
"""How far the edge may lie from the border of the mask, to either side [px]."""

LARGE = 100_000
"""Masks of more pixels than this are worked on in parts."""

LEAST_CONTRAST = 6.0
"""Levels between object and background below which a mixture cannot be told."""


def analyse_edges(
    mask: UInt8[Array, "height width"],
    frame: Image,
    background: Image | None = None,
    *,
    kind: int = 0,
) -> tuple[Blobs, Runs]:
    """Blobs of a mask with their edges placed by the frame, and their pixels that are at least half covered.

    Blob i is the runs with label i + 1.

    `background` is the frame without objects; without it the colours around each edge are taken. Axes
    are those of square pixels (MATLAB's convention). Where object and background are alike
    the mask stays as it is.
    """
    u0, v0, width, height = cv2.boundingRect(mask)
    if not width:
        return Blobs.empty(), Runs.of_mask(mask)
    margin = REACH + OUTSIDE
    left, top = max(u0 - margin, 0), max(v0 - margin, 0)
    part = np.s_[top : v0 + height + margin, left : u0 + width + margin]
    small = _padded(mask[part], 0)
    colours = _padded(frame[part])
    behind = None if background is None else _padded(background[part])
    edge, alpha = _coverage(small, colours, behind)

    covered = small.copy()
    covered.ravel()[edge] = alpha >= 0.5
    runs = Runs.of_mask(np.ascontiguousarray(covered[REACH:-REACH, REACH:-REACH]))
    v, u = np.divmod(edge, small.shape[1])
    labels = np.zeros(small.shape, dtype=np.uint16)
    numbers = np.arange(1, runs.count + 1).astype(np.uint16)
    labels[REACH:-REACH, REACH:-REACH] = runs.painted(
        numbers, (small.shape[0] - 2 * REACH, small.shape[1] - 2 * REACH)
    )
    label = _label_near(labels, edge)
    more = (label, u - REACH, v - REACH, alpha - covered.ravel()[edge])
    blobs = analyse_runs(runs, more=more, axes="matlab", kind=kind)
    return _moved(blobs, left, top), runs.moved(left, top)


def _coverage(
    mask: UInt8[Array, "h w"], colours: Image, behind: Image | None
) -> tuple[Int[Array, "k"], Float[Array, "k"]]:
    """Flat places around the border of the mask, and how much of each the object covers."""
    inside = np.where(mask, np.uint8(255), np.uint8(0))
    core = cv2.erode(inside, _square(INSIDE), borderValue=0)
    wide = cv2.dilate(inside, _square(OUTSIDE))
    rim = cv2.subtract(wide, core)
    rim[:REACH], rim[-REACH:], rim[:, :REACH], rim[:, -REACH:] = 0, 0, 0, 0
    edge = np.flatnonzero(rim.view(bool))
    parts = _parts(mask)
    front, has_core = _mean_near(colours, core, edge, parts)
    if behind is None:
        back, known = _mean_near(colours, cv2.bitwise_not(wide), edge, parts)
    else:
        back, known = behind.reshape(-1, 3)[edge].astype(np.float32), np.ones(len(edge), dtype=bool)
    seen = colours.reshape(-1, 3)
    thin = np.flatnonzero(~has_core)
    if len(thin):
        near = edge[thin, None] + _offsets(mask.shape[1])
        front[thin], has_core[thin] = _most_unlike(seen[near], back[thin], inside.ravel()[near])
    span = front - back
    length = np.einsum("kc,kc->k", span, span)
    told = known & has_core & (length > LEAST_CONTRAST**2)
    share = np.einsum("kc,kc->k", seen[edge] - back, span) / np.where(told, length, 1)
    return edge, np.where(told, np.clip(share, 0, 1), inside.ravel()[edge] > 0).astype(float)


def _parts(mask: UInt8[Array, "h w"]) -> list[tuple[slice, slice]]:
    """Rectangles that hold the mask and what is within reach of it: the whole, or where that is much less."""
    whole = [(slice(None), slice(None))]
    if mask.size < LARGE:
        return whole
    margin = INSIDE + OUTSIDE + 2 * REACH
    _, box = Runs.of_mask(mask).boxes()
    low, high = np.maximum(box[:, :2] - margin, 0), box[:, 2:] + margin
    if (high - low).prod(axis=1).sum() > mask.size / 2:
        return whole
    corners = np.concatenate([low, high], axis=1).tolist()
    return [(slice(top, bottom), slice(left, right)) for left, top, right, bottom in corners]


def _mean_near(
    colours: Image, chosen: UInt8[Array, "h w"], at: Int[Array, "k"], parts: list[tuple[slice, slice]]
) -> tuple[Float[Array, "k 3"], Bool[Array, "k"]]:
    """Mean colour of the chosen pixels (255, others 0) within reach of each place; where there are any."""
    size = (2 * REACH + 1,) * 2
    total = np.empty(colours.shape, dtype=np.uint16)
    count = np.empty(chosen.shape, dtype=np.uint8)
    one = chosen & 1
    for part in parts:
        kept = cv2.copyTo(colours[part], chosen[part])
        total[part] = cv2.boxFilter(kept, cv2.CV_16U, size, normalize=False)
        count[part] = cv2.boxFilter(one[part], cv2.CV_8U, size, normalize=False)
    n = count.ravel()[at]
    return total.reshape(-1, 3)[at] / np.maximum(n, 1).astype(np.float32)[:, None], n > 0


def _most_unlike(
    seen: UInt8[Array, "k m 3"], back: Float[Array, "k 3"], inside: UInt8[Array, "k m"]
) -> tuple[Float[Array, "k 3"], Bool[Array, "k"]]:
    """Where no neighbour is surely whole: their mean colour, mostly of those most unlike the background."""
    colour = seen.astype(np.float32)
    apart = colour - back[:, None]
    weight = np.einsum("kmc,kmc->km", apart, apart) ** 2 * (inside > 0)
    total = weight.sum(axis=1)
    return np.einsum("km,kmc->kc", weight, colour) / np.where(total > 0, total, 1)[:, None], total > 0


def _offsets(width: int) -> Int[Array, "m"]:
    """Steps to the eight neighbours and to four a pixel further."""
    steps = [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b] + [(-2, 0), (2, 0), (0, -2), (0, 2)]
    return np.array([a * width + b for a, b in steps])


def _square(reach: int) -> UInt8[Array, "k k"]:
    return np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)


def _padded(image: Array, value: int | None = None) -> Array:
    border = cv2.BORDER_REPLICATE if value is None else cv2.BORDER_CONSTANT
    return np.asarray(cv2.copyMakeBorder(image, REACH, REACH, REACH, REACH, border, value=[value or 0]))


def _label_near(labels: UInt16[Array, "h w"], place: Int[Array, "k"]) -> Int[Array, "k"]:
    """The label at each place, or one within two pixels; 0 where there is none."""
    own = labels.ravel()[place]
    near = np.asarray(cv2.dilate(labels, _square(OUTSIDE))).ravel()[place]
    return np.where(own > 0, own, near).astype(np.int64)


def _moved(blobs: Blobs, left: int, top: int) -> Blobs:
    """The blobs with their origin shifted."""
    shift = np.array([left, top], dtype=float)
    return Blobs(
        centroid_px=blobs.centroid_px + shift,
        box_px=blobs.box_px + np.concatenate([shift, [0, 0]]),
        area_px=blobs.area_px,
        axes_px=blobs.axes_px,
        yaw_rad=blobs.yaw_rad,
        score=blobs.score,
        kind=blobs.kind,
        extra=blobs.extra,
    )
