"""How a grid of corners lies in the picture: the direction and the bend of its edges.

Around a corner the edges of a board are straight but for the lens, the board's own warp and, beyond
first order, perspective. A bend read off one corner's few pixels costs precision; the
whole grid knows it nearly without noise.
"""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.types import Array, Bool, Float

__all__ = ["GridShape", "grid_shape", "strays", "without_strays"]

STEP = 0.3
"""Half width, in squares, of the differences that stand for derivatives."""

STRAY_SQUARES = 0.12
"""Corners farther than this from where the others put them are strays."""


@dataclass(frozen=True)
class GridShape:
    """The two edges through each of n corners.

    `edges` (n, 2, 2): for the edge along the columns (0) and along the rows (1) the vector to the next
    corner [px]. `curvature` (n, 2) [1/px]: an edge runs through ``s t + s² curvature n / 2`` with
    t its unit vector and n the unit normal ``(-t_v, t_u)``.
    """

    edges: Float[Array, "n 2 2"]
    curvature: Float[Array, "n 2"]

    def take(self, some: Array) -> "GridShape":
        """The shape at some of the corners."""
        return GridShape(self.edges[some], self.curvature[some])


def grid_shape(grid: Float[Array, "rows columns 2"], *, degree: int) -> GridShape:
    """Shape of a grid, smoothed by a homography and a polynomial of at most `degree`."""
    plane, half = _plane(grid)
    smooth = _SmoothGrid.through(plane, grid.reshape(-1, 2), np.ones(len(plane), dtype=bool), degree)
    here = smooth.pixels(plane)
    edges, curvature = np.empty((len(plane), 2, 2)), np.empty((len(plane), 2))
    for axis in range(2):
        step = np.eye(2)[axis] * STEP / half
        ahead, behind = smooth.pixels(plane + step), smooth.pixels(plane - step)
        first, second = (ahead - behind) / 2, ahead + behind - 2 * here
        turn = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        edges[:, axis] = first / STEP
        curvature[:, axis] = turn / np.linalg.norm(first, axis=1) ** 3
    return GridShape(edges, curvature)


def without_strays(grid: Float[Array, "rows columns 2"]) -> Float[Array, "rows columns 2"]:
    """The grid with corners that do not fit in with the others put where these say they are.

    A detector's refinement is drawn to shadows and stains; no start must be lost for it.
    """
    square = np.sqrt(np.abs(np.linalg.det(grid_shape(grid, degree=0).edges)))
    allowed = STRAY_SQUARES * square + 0.5
    inlier, expected = _agreeing(grid, 3, lambda _: allowed)
    return np.where(inlier[:, None], grid.reshape(-1, 2), expected).reshape(grid.shape)


def strays(grid: Float[Array, "rows columns 2"]) -> Bool[Array, "n"]:
    """Which corners are far off the smooth grid of the others, measured by how well these agree.

    For grids that have been refined: more than eight times the usual misfit and a quarter of a pixel.
    """
    return ~_agreeing(grid, 4, lambda misfit: np.full(grid.shape[:2], max(8 * misfit, 0.25)).ravel())[0]


def _agreeing(
    grid: Float[Array, "rows columns 2"], degree: int, allowed: Callable[[float], Array]
) -> tuple[Bool[Array, "n"], Float[Array, "n 2"]]:
    """Corners within ``allowed(median misfit)`` of a smooth grid through themselves, and that grid."""
    plane, _ = _plane(grid)
    pixels = grid.reshape(-1, 2)
    inlier = np.ones(len(pixels), dtype=bool)
    # The first surface must not follow the strays: few terms, and a homography by most votes.
    for terms, slack in ((2, 3), (degree, 1), (degree, 1), (degree, 1)):
        expected = _SmoothGrid.through(plane, pixels, inlier, terms, robust=True).pixels(plane)
        misfit = np.linalg.norm(pixels - expected, axis=1)
        inlier = misfit < slack * allowed(float(np.median(misfit[inlier])))
        if inlier.sum() < max(9, 0.6 * len(pixels)):
            return np.ones(len(pixels), dtype=bool), expected
    return inlier, expected


@dataclass(frozen=True)
class _SmoothGrid:
    """Map from the board's plane to pixels: a homography, and a polynomial for lens and warp."""

    homography: Float[Array, "3 3"]
    powers: tuple[tuple[int, int], ...]
    bends: Float[Array, "k 2"]

    @classmethod
    def through(
        cls,
        plane: Float[Array, "n 2"],
        pixels: Float[Array, "n 2"],
        use: Bool[Array, "n"],
        degree: int,
        *,
        robust: bool = False,
    ) -> "_SmoothGrid":
        """Least squares; the degree is lowered until there are twice as many corners as terms."""
        at, seen = plane[use], np.asarray(pixels[use], dtype=float)
        homography = cv2.findHomography(at, seen, cv2.LMEDS if robust else 0)[0]
        degree = min(degree, *(len(np.unique(at[:, axis])) - 1 for axis in range(2)))
        while (degree + 1) * (degree + 2) > len(at):
            degree -= 1
        powers = [(a, b) for a in range(degree + 1) for b in range(degree + 1 - a)] if degree > 1 else []
        bare = cls(homography, tuple(powers), np.zeros((len(powers), 2)))
        rest = seen - bare.pixels(at)
        return cls(homography, tuple(powers), np.linalg.lstsq(bare.terms(at), rest, rcond=None)[0])

    def terms(self, plane: Float[Array, "n 2"]) -> Float[Array, "n k"]:
        x, y = plane.T
        return np.array([x**a * y**b for a, b in self.powers]).reshape(len(self.powers), len(plane)).T

    def pixels(self, plane: Float[Array, "n 2"]) -> Float[Array, "n 2"]:
        p = np.column_stack([plane, np.ones(len(plane))]) @ self.homography.T
        return p[:, :2] / p[:, 2:] + self.terms(plane) @ self.bends


def _plane(grid: Float[Array, "rows columns 2"]) -> tuple[Float[Array, "n 2"], float]:
    """Positions of the corners on the board within [-1, 1], and squares per unit."""
    rows, columns = grid.shape[:2]
    half = max(rows, columns) / 2
    y, x = np.mgrid[0:rows, 0:columns].reshape(2, -1)
    return np.stack([x - (columns - 1) / 2, y - (rows - 1) / 2], axis=1) / half, half
