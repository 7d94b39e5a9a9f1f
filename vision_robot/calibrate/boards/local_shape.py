"""How a partly seen board lies in the picture around each of its corners.

A homography takes the perspective of the whole; what it leaves is fitted by a polynomial to the corners
nearest to a place: a lens, however strong, bends little over so small a patch.
(`vision_robot.calibrate.grid_shape` does it for full grids with one polynomial for all, which a
fisheye at a slant does not follow.)
"""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.types import Array, Bool, Float

__all__ = ["Patch", "local_patches"]

NEAREST = 24
POWERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))
TERMS = (10, 6, 3)
"""Numbers of terms of the polynomials of degree three, two and one."""

FEWEST = 5

STEEPEST = 0.2
"""A homography in which some places lie this much nearer than others is left out: it would bend too much."""


@dataclass(frozen=True)
class Patch:
    """Local maps from board to picture at n places.

    `pixels` (n, 2) and how well they are known by the fit's own misfit, `doubt_px` (n,); `slope` (n, 2, 2)
    [px/m], its row i the derivative along axis i of the board; `curvature` (n, 2) [1/px] of the lines
    along x and along y, signed as in `GridShape`; `known` (n,) whether there were corners enough around.
    """

    pixels: Float[Array, "n 2"]
    doubt_px: Float[Array, "n"]
    slope: Float[Array, "n 2 2"]
    curvature: Float[Array, "n 2"]
    known: Bool[Array, "n"]


def local_patches(
    points: Float[Array, "m 2"],
    pixels: Float[Array, "m 2"],
    places: Float[Array, "n 2"],
    *,
    leave_out: bool = False,
) -> Patch:
    """Fit around `places` [m] the corners seen at `pixels`, whose board positions are `points` [m].

    The degree is three where corners suffice, else two or one. `leave_out` keeps each place's own
    corner out of its fit, so that the two can be compared.
    """
    n = len(places)
    patch = Patch(
        np.zeros((n, 2)), np.zeros(n), np.zeros((n, 2, 2)), np.zeros((n, 2)), np.zeros(n, dtype=bool)
    )
    extent = np.ptp(points, axis=0).max()
    tiny, step = 1e-6 * extent, 1e-3 * extent
    ideal = _perspective(points, pixels, places)
    rest = pixels - ideal(points)
    here = ideal(places)
    for k, place in enumerate(places):
        away = points - place
        distance = np.linalg.norm(away, axis=1)
        if leave_out:
            distance[distance <= tiny] = np.inf
        near = np.argsort(distance, kind="stable")[:NEAREST]
        near = near[np.isfinite(distance[near])]
        if len(near) < FEWEST:
            continue
        scale = distance[near].max()
        found = _fitted(away[near] / scale, rest[near])
        if found is None:
            continue
        fit, patch.doubt_px[k] = found
        ahead, behind = ideal(place + step * np.eye(2)), ideal(place - step * np.eye(2))
        first = (ahead - behind) / (2 * step) + fit[1:3] / scale
        second = (ahead - 2 * here[k] + behind) / step**2
        if len(fit) > 3:
            second = second + 2 * fit[[3, 5]] / scale**2
        patch.pixels[k], patch.slope[k], patch.known[k] = here[k] + fit[0], first, True
        turn = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        patch.curvature[k] = turn / np.linalg.norm(first, axis=1) ** 3
    return patch


def _perspective(
    points: Float[Array, "m 2"], pixels: Float[Array, "m 2"], places: Float[Array, "n 2"]
) -> Callable[[Float[Array, "k 2"]], Float[Array, "k 2"]]:
    """The homography nearest to what is seen; constant where there is none with all places before the eye."""
    H, _ = cv2.findHomography(points, pixels) if len(points) >= 4 else (None, None)
    if H is not None:
        depth = np.concatenate([points, places]) @ H[2, :2] + H[2, 2]
        if depth.min() > STEEPEST * depth.max():
            return lambda at: (at @ H[:2, :2].T + H[:2, 2]) / (at @ H[2, :2] + H[2, 2])[:, None]
    return np.zeros_like


def _fitted(
    away: Float[Array, "k 2"], pixels: Float[Array, "k 2"]
) -> tuple[Float[Array, "t 2"], float] | None:
    """Coefficients of the highest degree that the points determine well, and the doubt about the first.

    Near points weigh more.
    """
    weight = 1 / (0.3 + np.linalg.norm(away, axis=1))[:, None]
    x, y = away.T
    columns = np.stack([x**a * y**b for a, b in POWERS], axis=1) * weight
    target = pixels * weight
    for terms in TERMS:
        if 1.4 * terms > len(away):
            continue
        U, singular, Vt = np.linalg.svd(columns[:, :terms], full_matrices=False)
        if singular[-1] < 0.01 * singular[0]:
            continue
        fit = Vt.T @ ((U.T @ target) / singular[:, None])
        rest = columns[:, :terms] @ fit - target
        variance = np.square(rest).sum() / (2 * (len(away) - terms))
        spread = np.square(Vt[:, 0] / singular).sum()
        return fit, float(np.sqrt(variance * spread))
    return None
