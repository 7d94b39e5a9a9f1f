"""Shadows and patches of light: pixels that show the background's own colour, darker or brighter."""

import cv2
import numpy as np

from vision_robot.track.runs import Runs
from vision_robot.types import Array, Bool, Float, Image, Int, UInt8

__all__ = ["without_shadows"]

DARKEST, BRIGHTEST = 0.25, 0.97
"""Share of the light left in a shadow; darker is taken for an object, brighter for none."""

LEFT = 0.15
"""A piece keeps its shadow-like pixels unless at least this share of it is something else."""

CRUMB = 0.1
"""What shadows leave of a piece counts from this share of its largest rest on."""

SAME_TEXTURE = 0.5
"""Correlation of fine detail from which a piece shows the background itself, in another light."""

DETAIL_PX, FEWEST_PX = 5, 50
"""Detail is what differs from the mean of so many pixels across; fewer inner pixels tell nothing."""

REACH = 2
"""How far from a shadow its light still is the background's [px]."""


def without_shadows(
    mask: UInt8[Array, "height width"], frame: Image, background: Image, noise_levels: float
) -> tuple[UInt8[Array, "height width"], Image]:
    """The mask less shadows and patches of light, and the background in the shadows that objects throw.

    A pixel is shadow-like where its colour is the background's times one factor, within the noise. A piece
    that is so nearly everywhere goes as a whole where the background's fine detail shows through, and keeps
    all its pixels where not: a grey thing on a plain grey table looks the same.
    """
    left, top, width, height = cv2.boundingRect(mask)
    if not width:
        return mask, background
    part = np.s_[max(top - REACH, 0) : top + height + REACH, max(left - REACH, 0) : left + width + REACH]
    inner, seen, behind = np.ascontiguousarray(mask[part]), frame[part], background[part]
    at = np.flatnonzero(inner)
    factor, like = _factor(seen.reshape(-1, 3)[at], behind.reshape(-1, 3)[at], noise_levels)
    if not like.any():
        return mask, background
    runs = Runs.of_mask(inner)
    label = np.repeat(runs.label, runs.stop - runs.first) - 1  # in the order of the pixels
    area = np.bincount(label, minlength=runs.count)
    other = np.bincount(label, ~like, minlength=runs.count) / area
    shadow = like & (factor < BRIGHTEST) & (other >= LEFT)[label]
    through = other < LEFT
    if through.any():
        texture = _texture(seen, behind, inner, label)
        same = texture > SAME_TEXTURE
        if shadow.any():
            # Specks too small for detail are of the shadows beside them where they are as dark.
            darkest, brightest = np.quantile(factor[shadow], (0.05, 0.95))
            mean = np.bincount(label, factor, minlength=runs.count) / area
            same |= np.isnan(texture) & (mean > darkest) & (mean < brightest)
        through &= same
    rest = inner.copy()
    rest.ravel()[at[shadow | through[label]]] = 0
    kept, lit = mask.copy(), background
    kept[part] = _without_crumbs(rest, at, label)
    if shadow.any():
        lit = background.copy()
        _shade(lit[part], rest, at[shadow], factor[shadow])
    return kept, lit


def _factor(
    now: UInt8[Array, "k 3"], then: UInt8[Array, "k 3"], noise: float
) -> tuple[Float[Array, "k"], Bool[Array, "k"]]:
    """By how much the light has changed, and whether light alone can have done it."""
    x, b = now.astype(np.float32), then.astype(np.float32)
    length = np.einsum("kc,kc->k", b, b)
    factor = np.einsum("kc,kc->k", x, b) / np.maximum(length, 1)
    rest = x - factor[:, None] * b
    allowed = 3 * noise + 0.03 * np.sqrt(length)
    like = (factor > DARKEST) & (factor < 1 / DARKEST)
    return factor, like & (np.einsum("kc,kc->k", rest, rest) < allowed**2)


def _texture(seen: Image, behind: Image, mask: UInt8[Array, "h w"], label: Array) -> Float[Array, "n"]:
    """Correlation of the fine detail of frame and background in each piece; NaN where it cannot be told."""
    count = int(label.max()) + 1
    core = cv2.erode(mask, np.ones((DETAIL_PX, DETAIL_PX), np.uint8), borderValue=0)[mask > 0] > 0
    fine = []
    for picture in (seen, behind):
        grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY).astype(np.float32)
        fine.append((grey - cv2.blur(grey, (DETAIL_PX, DETAIL_PX)))[mask > 0] * core)
    a, b = fine
    cross, own, theirs = (np.bincount(label, one, minlength=count) for one in (a * b, a * a, b * b))
    told = np.bincount(label, core, minlength=count) >= FEWEST_PX
    return np.where(told, cross / np.sqrt(np.maximum(own * theirs, 1e-9)), np.nan)


def _without_crumbs(
    rest: UInt8[Array, "h w"], at: Int[Array, "k"], label: Int[Array, "k"]
) -> UInt8[Array, "h w"]:
    """The rest less what is much smaller than the largest rest of its piece, by the label of pixels `at`."""
    left = Runs.of_mask(rest)
    count = int(label.max()) + 1
    if left.count == count:
        return rest
    piece = np.zeros(left.count, dtype=np.int64)
    piece[left.label - 1] = label[np.searchsorted(at, left.v * rest.shape[1] + left.first)]
    area = np.bincount(left.label - 1, left.stop - left.first, minlength=left.count)
    largest = np.zeros(count)
    np.maximum.at(largest, piece, area)
    kept = area >= CRUMB * largest[piece]
    return left.painted(
        np.where(kept, rest.max(initial=1), 0).astype(np.uint8), (rest.shape[0], rest.shape[1])
    )


def _shade(behind: Image, rest: UInt8[Array, "h w"], at: Int[Array, "k"], factor: Float[Array, "k"]) -> None:
    """Multiply the background, in place, with the mean factor of the shadow pixels near each pixel.

    Only outside of what is left: the dark side of an object must not pass for background in the shade.
    """
    total, count = np.zeros(rest.shape, np.float32), np.zeros(rest.shape, np.float32)
    total.ravel()[at], count.ravel()[at] = factor, 1
    size = (2 * REACH + 1,) * 2
    total, count = cv2.boxFilter(total, -1, size), cv2.boxFilter(count, -1, size)
    v, u = np.nonzero((count > 0.5 / size[0] ** 2) & (rest == 0))
    light = total[v, u] / count[v, u]
    behind[v, u] = np.clip(behind[v, u] * light[:, None], 0, 255).astype(np.uint8)
