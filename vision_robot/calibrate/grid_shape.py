"""How a grid of corners lies in the picture: the direction and the bend of its edges.

Around a corner the edges of a board are straight but for the lens, the board's own warp and, beyond
first order, perspective. A bend read off one corner's few pixels costs precision; the
whole grid knows it nearly without noise.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.types import Array, Float

__all__ = ["GridShape", "grid_shape"]

STEP = 0.3
"""Half width, in squares, of the differences that stand for derivatives."""


@dataclass(frozen=True)
class GridShape:
    """The two edges through each of n corners.

    `edges` (n, 2, 2): for the edge along the columns (0) and along the rows (1) the vector to the next
    corner [px]. `curvature` (n, 2) [1/px]: an edge runs through ``s t + s² curvature n / 2`` with
    t its unit vector and n the unit normal ``(-t_v, t_u)``.
    """

    edges: Float[Array, "n 2 2"]
    curvature: Float[Array, "n 2"]


def grid_shape(grid: Float[Array, "rows columns 2"], *, degree: int) -> GridShape:
    """Shape of a grid from a homography and a polynomial of at most `degree` in both directions.

    The degree is lowered until there are twice as many corners as terms; a homography alone, for small
    grids, has straight edges.
    """
    rows, columns = grid.shape[:2]
    half = max(rows, columns) / 2
    y, x = np.mgrid[0:rows, 0:columns].reshape(2, -1)
    plane = np.stack([x - (columns - 1) / 2, y - (rows - 1) / 2], axis=1) / half
    pixels = np.asarray(grid, dtype=float).reshape(-1, 2)
    homography = cv2.findHomography(plane, pixels)[0]
    degree = min(degree, rows - 1, columns - 1)
    while (degree + 1) * (degree + 2) > len(pixels):
        degree -= 1
    powers = [(a, b) for a in range(degree + 1) for b in range(degree + 1 - a)] if degree > 1 else []

    def terms(at: Float[Array, "n 2"]) -> Float[Array, "n k"]:
        return np.array([at[:, 0] ** a * at[:, 1] ** b for a, b in powers]).reshape(len(powers), len(at)).T

    def ideal(at: Float[Array, "n 2"]) -> Float[Array, "n 2"]:
        p = np.column_stack([at, np.ones(len(at))]) @ homography.T
        return p[:, :2] / p[:, 2:]

    bends = np.linalg.lstsq(terms(plane), pixels - ideal(plane), rcond=None)[0]

    def place(at: Float[Array, "n 2"]) -> Float[Array, "n 2"]:
        return ideal(at) + terms(at) @ bends

    here = place(plane)
    edges, curvature = np.empty((len(pixels), 2, 2)), np.empty((len(pixels), 2))
    for axis in range(2):
        step = np.eye(2)[axis] * STEP / half
        ahead, behind = place(plane + step), place(plane - step)
        first, second = (ahead - behind) / 2, ahead + behind - 2 * here
        turn = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        edges[:, axis] = first / STEP
        curvature[:, axis] = turn / np.linalg.norm(first, axis=1) ** 3
    return GridShape(edges, curvature)
