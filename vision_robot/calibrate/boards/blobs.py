"""Dark blobs that may be printed discs seen at a slant."""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.types import Array, Float, Int, UInt8

__all__ = ["EllipseBlobs", "dark_blobs"]

Grey = UInt8[Array, "height width"]

LARGE_PX, SMALL_PX = 2600, 1300
"""Longer pictures are shrunk first; shorter ones are also tried magnified."""

FEWEST_OUTLINE_PIXELS = 8
SMALLEST_PX = 1.0
"""Least half axis of an outline through pixel centres; smaller discs are found when magnified."""

LARGEST = 0.05
"""Largest blob as a share of the picture."""

AREA_TOLERANCE = 0.1
SLIMMEST = 0.12
"""Least ratio of the axes of an ellipse: a disc tilted by 83 degrees."""


@dataclass(frozen=True)
class EllipseBlobs:
    """Blobs as a table: `centres` (n, 2) and `spreads` (n, 2, 2).

    With S the spread, the outline is ``(x - centre) . inv(S) . (x - centre) = 1`` [px].
    """

    centres: Float[Array, "n 2"]
    spreads: Float[Array, "n 2 2"]

    def __len__(self) -> int:
        return len(self.centres)

    @property
    def radii(self) -> Float[Array, "n"]:
        """Radius of the disc of equal area [px]."""
        return np.linalg.det(self.spreads) ** 0.25


def dark_blobs(grey: Grey) -> Iterator[EllipseBlobs]:
    """Attempts at finding the dark ellipses of a picture, the most promising first."""
    long_side = max(grey.shape)
    base = min(1.0, LARGE_PX / long_side)
    pictures = [(grey, base, 0.0), (grey, base, 1.5)]
    if long_side * base > 700:
        pictures.append((grey, base / 2, 1.0))
    if long_side < SMALL_PX:
        pictures.append((grey, 2.0, 1.5))
    pictures.append((grey, base, 3.0))
    for original, scale, blur in pictures:
        picture = original
        if scale != 1:
            method = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
            picture = cv2.resize(original, None, fx=scale, fy=scale, interpolation=method)
        if blur:
            picture = cv2.GaussianBlur(picture, (0, 0), blur)
        ratio = np.array([grey.shape[1] / picture.shape[1], grey.shape[0] / picture.shape[0]])
        for mask in _dark_masks(picture):
            blobs = _ellipses(mask)
            yield EllipseBlobs((blobs.centres + 0.5) * ratio - 0.5, blobs.spreads * np.outer(ratio, ratio))


def _dark_masks(picture: Grey) -> Iterator[Grey]:
    """Where the picture is darker than its surroundings, for surroundings of several sizes."""
    long_side = max(picture.shape)
    contrast = float(np.subtract(*np.percentile(picture, (98, 2))))
    for share, offset in ((0.08, 0.1), (0.2, 0.12), (0.03, 0.08), (0.08, 0.03)):
        block = 2 * (int(share * long_side) // 2) + 3
        mean = cv2.boxFilter(picture, -1, (block, block), borderType=cv2.BORDER_REPLICATE)
        yield (picture.astype(np.int16) < mean.astype(np.int16) - max(2.0, offset * contrast)).astype(
            np.uint8
        )
    level, _ = cv2.threshold(picture, 0, 255, cv2.THRESH_OTSU)
    yield (picture <= level).astype(np.uint8)


def _ellipses(mask: Grey) -> EllipseBlobs:
    """Connected regions whose outline is an ellipse's."""
    outlines, _ = cv2.findContours(mask, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    outlines = [outline for outline in outlines if len(outline) >= FEWEST_OUTLINE_PIXELS]
    table = np.array([_moments(outline) for outline in outlines]).reshape(-1, 6)
    table[:, 0] = np.where((table[:, 0] >= 4) & (table[:, 0] <= LARGEST * mask.size), table[:, 0], np.nan)
    area, centres, (xx, xy, yy) = table[:, 0], table[:, 1:3] / table[:, :1], 4 * table[:, 3:].T / table[:, 0]
    # Squared half axes: an ellipse's second moments are a quarter of them.
    mean, half = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    low, high = mean - half, mean + half
    with np.errstate(invalid="ignore"):
        good = (low > SMALLEST_PX**2) & (low > SLIMMEST**2 * high)
        good &= np.abs(area - np.pi * np.sqrt(np.maximum(low * high, 0))) < AREA_TOLERANCE * area
    spreads = np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2)
    for k in np.flatnonzero(good):
        good[k] = _is_ellipse(outlines[k].reshape(-1, 2) - centres[k], spreads[k], float(np.sqrt(low[k])))
    # Outlines run through the centres of the outermost pixels, half a pixel inside the edge.
    grown = (1 + 0.5 / np.sqrt(low[good])) * (1 + 0.5 / np.sqrt(high[good]))
    return EllipseBlobs(centres[good], spreads[good] * grown[:, None, None])


def _moments(outline: Int[Array, "n 1 2"]) -> tuple[float, ...]:
    m = cv2.moments(outline)
    return m["m00"], m["m10"], m["m01"], m["mu20"], m["mu11"], m["mu02"]


def _is_ellipse(outline: Float[Array, "n 2"], spread: Float[Array, "2 2"], half_axis: float) -> bool:
    """Whether the outline keeps to the ellipse of its own moments to 6 % or a third of a pixel, rms."""
    radius = np.sqrt(np.einsum("ni,ij,nj->n", outline, np.linalg.inv(spread), outline))
    return bool(np.sqrt(np.mean((radius - 1) ** 2)) < 0.06 + 0.3 / half_axis)
