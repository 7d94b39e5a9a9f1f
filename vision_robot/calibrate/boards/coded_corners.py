"""From a coded board's markers to its measured corners.

The markers say roughly where each corner is; a corner counts when its four quadrants are seen in the right
colours, so that hidden corners and those outside the picture are left out. The corners so found say well
where the others are, and whether they themselves lie as their neighbours do.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.calibrate.boards.local_shape import local_patches
from vision_robot.calibrate.boards.marker_finder import Markers, local_pixels
from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.grid_shape import GridShape
from vision_robot.calibrate.saddle import REACH, Saddles, fit_saddles
from vision_robot.types import Array, Bool, Float, Int, UInt8

__all__ = ["CornerSites", "coded_corners"]

Grey = UInt8[Array, "height width"]

QUADRANTS = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
QUADRANT = 0.35
"""Where in a quadrant its colour is sampled, along both axes, in radii of the clear disc."""

FARTHEST = 1.25
"""Corners farther than this from the centre of a seen marker, in sides of a marker, are not looked for."""

SURE_PX = 0.5
"""Sigma above which a corner is not worth having."""

MOST_ROUNDS = 3

OFF_PX, OFF_SIGMAS, MOST_REJECTIONS = 0.5, 8.0, 20
"""A corner farther from where its neighbours say than both is none: pixels, standard deviations."""


@dataclass(frozen=True)
class CornerSites:
    """Where a board has corners: `points` (n, 2) [m] in its own frame.

    `clear_m` is the radius of the disc around a corner in which nothing but the corner is printed.
    `dark_diagonal` tells where the quadrant right of and below the corner, and its opposite, are the
    black ones.
    """

    points: Float[Array, "n 2"]
    clear_m: float
    dark_diagonal: Bool[Array, "n"]


def coded_corners(
    grey: Grey, markers: Markers, corners_in_board: Float[Array, "m 4 2"], sites: CornerSites, *, name: str
) -> Corners | None:
    """Corners next to the markers that are seen, refined; None when there is none."""
    step = QUADRANT * sites.clear_m
    offsets = np.concatenate([np.zeros((1, 2)), step * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])])
    around, reach = local_pixels(markers, corners_in_board, sites.points[:, None] + offsets)
    slope = np.stack([around[:, 1] - around[:, 2], around[:, 3] - around[:, 4]], axis=1) / (2 * step)
    near = np.flatnonzero(reach < FARTHEST)
    ids, saddles = _measured(grey, sites, near, around[near, 0], slope[near])
    side = float(np.linalg.norm(corners_in_board[0, 1] - corners_in_board[0, 0]))
    for _ in range(MOST_ROUNDS):
        before = len(ids)
        ids, saddles = _from_neighbours(grey, sites, ids, saddles, within_m=FARTHEST * side)
        if len(ids) <= before:
            break
    agrees = _agree(sites, ids, saddles)
    if not agrees.any():
        return None
    return Corners(name, ids[agrees], saddles.pixels[agrees], saddles.sigma_px[agrees])


def _from_neighbours(
    grey: Grey, sites: CornerSites, ids: Int[Array, "n"], saddles: Saddles, *, within_m: float
) -> tuple[Int[Array, "k"], Saddles]:
    """Measure again, and beyond what is seen, from where the corners measured so far say."""
    if not len(ids):
        return ids, saddles
    patch = local_patches(sites.points[ids], saddles.pixels, sites.points)
    if not patch.known[ids].all():
        return ids, saddles
    apart = np.linalg.norm(sites.points[:, None] - sites.points[ids], axis=2).min(axis=1)
    wanted = np.flatnonzero(patch.known & (apart < within_m))
    return _measured(grey, sites, wanted, patch.pixels[wanted], patch.slope[wanted])


def _agree(sites: CornerSites, ids: Int[Array, "n"], saddles: Saddles) -> Bool[Array, "n"]:
    """Which corners lie where the others around them say; the worst is judged first."""
    keep = np.ones(len(ids), dtype=bool)
    for _ in range(MOST_REJECTIONS):
        points, pixels = sites.points[ids[keep]], saddles.pixels[keep]
        patch = local_patches(points, pixels, points, leave_out=True)
        off = np.linalg.norm(pixels - patch.pixels, axis=1)
        expected = OFF_SIGMAS * np.hypot(patch.doubt_px, saddles.sigma_px[keep])
        excess = np.where(patch.known, off / np.maximum(OFF_PX, expected), 0)
        if not (excess > 1).any():
            break
        keep[np.flatnonzero(keep)[excess > max(1, 0.7 * excess.max())]] = False
    return keep


def _measured(
    grey: Grey,
    sites: CornerSites,
    ids: Int[Array, "n"],
    start: Float[Array, "n 2"],
    slope: Float[Array, "n 2 2"],
) -> tuple[Int[Array, "k"], Saddles]:
    """Those corners that are seen near their starts."""
    seen = _shows_saddle(grey, sites, ids, start, slope)
    ids, start, slope = ids[seen], start[seen], slope[seen]
    # The fit's windows reach REACH of an edge: let that be the clear disc, with a little to spare.
    edges = slope * sites.clear_m * (0.95 / REACH)

    def shape(pixels: Float[Array, "n 2"], degree: int) -> GridShape:  # noqa: ARG001
        patch = local_patches(sites.points[ids], pixels, sites.points[ids])
        return GridShape(edges, patch.curvature)

    if not len(ids):
        return ids, Saddles(start, np.zeros((0, 2, 2)), np.zeros(0), seen[:0])
    saddles = fit_saddles(grey, start, shape)
    seen = saddles.fitted & (saddles.sigma_px < SURE_PX)
    seen &= _shows_saddle(grey, sites, ids, saddles.pixels, slope)
    kept = Saddles(
        saddles.pixels[seen], saddles.covariance[seen], saddles.blur_px[seen], saddles.fitted[seen]
    )
    return ids[seen], kept


def _shows_saddle(
    grey: Grey,
    sites: CornerSites,
    ids: Int[Array, "n"],
    pixels: Float[Array, "n 2"],
    slope: Float[Array, "n 2 2"],
) -> Bool[Array, "n"]:
    """Whether both quadrants that should be black are in view and darker than both that should be white."""
    if not len(ids):
        return np.zeros(0, dtype=bool)
    quadrants = pixels[:, None] + QUADRANT * sites.clear_m * QUADRANTS @ slope
    inside = np.all((quadrants >= 0) & (quadrants <= np.array(grey.shape[::-1]) - 1), axis=(1, 2))
    u, v = np.moveaxis(np.where(inside[:, None, None], quadrants, 0).astype(np.float32), -1, 0)
    samples = cv2.remap(grey, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE).astype(float)
    flip = np.where(sites.dark_diagonal[ids], 1.0, -1.0)[:, None]
    first, second = flip * samples[:, [0, 2]], flip * samples[:, [1, 3]]
    return inside & (first.max(axis=1) < second.min(axis=1))
