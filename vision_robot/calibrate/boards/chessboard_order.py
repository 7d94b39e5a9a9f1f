"""Which corner of a chessboard is the first: read off the picture's own colours.

OpenCV's two detectors number corners from opposite ends, and both transpose square boards,
so neither order is trusted: the grid is taken as a set of rows, and turned until it agrees with the print.
"""

import cv2
import numpy as np

from vision_robot.types import Array, Float, UInt8

__all__ = ["canonical_grid", "checker_agreement", "is_whole_board"]

Grey = UInt8[Array, "height width"]
Grid = Float[Array, "rows columns 2"]


LEAST_INSIDE, LEAST_AROUND, MOST_FURTHER = 0.9, 0.4, 0.6
"""How well colours alternate between the corners, in the squares around these, and beyond."""


def is_whole_board(grey: Grey, grid: Grid) -> bool:
    """Whether a grid of corners is a board, and all of it.

    Colours alternate between the corners; so do those of the squares around the outermost corners; and beyond
    these no further square follows, as it would if the grid were part of a larger board.
    """
    if abs(checker_agreement(grey, grid)) < LEAST_INSIDE:
        return False
    sides = [np.rot90(grid, k) for k in range(4)]
    around = [_alternation(grey, side, 0.3) for side in sides]
    further = [_alternation(grey, side, 1.3) for side in sides]
    return all(a is None or a > LEAST_AROUND for a in around) and all(
        f is None or f < MOST_FURTHER for f in further
    )


def checker_agreement(grey: Grey, grid: Grid) -> float:
    """How well the colours between the corners alternate as on a board whose first square is black.

    The mean over neighbouring squares of +1 (right order of brightness) and -1 (wrong): 1 for the
    right grid, -1 for one whose colours are swapped, about 0 for a grid that is no board.
    """
    centres = (grid[:-1, :-1] + grid[:-1, 1:] + grid[1:, :-1] + grid[1:, 1:]) / 4
    brightness = _brightness(grey, centres, grid)
    row, column = np.indices(brightness.shape)
    sign = np.where((row + column) % 2 == 0, 1.0, -1.0)
    across = np.sign(brightness[:, 1:] - brightness[:, :-1]) * sign[:, :-1]
    down = np.sign(brightness[1:] - brightness[:-1]) * sign[:-1]
    return float(np.concatenate([across.ravel(), down.ravel()]).mean())


def _alternation(grey: Grey, grid: Grid, beyond: float) -> float | None:
    """How well squares outside the first row carry the pattern on: 1 fully, 0 not at all.

    The squares are taken `beyond` squares above the row. Median over neighbours of the step from one to the
    next, against the step that the first row of squares makes there, so that shadows do not count.
    None where less than half of the squares lie in the picture.
    """
    # A parabola through three rows follows perspective well enough for one or two more.
    a, b, c = grid[0], grid[1], grid[2]
    line = a + beyond * (2.5 * (a - b) - 0.5 * (b - c) - a + b) + beyond**2 / 2 * (a - 2 * b + c)
    spots = (line[1:] + line[:-1]) / 2
    height, width = grey.shape
    inside = ((spots >= 0) & (spots <= [width - 1, height - 1])).all(axis=1)
    if inside.sum() < len(spots) / 2:
        return None
    first = (a[1:] + a[:-1] + b[1:] + b[:-1]) / 4
    own, there = _brightness(grey, np.stack([first, spots]), grid)
    flips = -1.0 if int(beyond) % 2 == 0 else 1.0
    both = inside[1:] & inside[:-1]
    steps, expected = np.diff(there)[both], flips * np.diff(own)[both]
    sure = np.abs(expected) > 0
    return float(np.median(steps[sure] / expected[sure])) if sure.any() else 0.0


def _brightness(grey: Grey, spots: Float[Array, "a b 2"], grid: Grid) -> Float[Array, "a b"]:
    """Mean brightness around spots, over a third of a square."""
    square = min(np.linalg.norm(np.diff(grid, axis=axis), axis=2).min() for axis in (0, 1))
    smooth = cv2.blur(grey, (max(1, int(0.3 * square)),) * 2)
    u, v = spots.astype(np.float32).transpose(2, 0, 1)
    return cv2.remap(smooth, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE).astype(float)


def canonical_grid(
    grey: UInt8[Array, "height width"], grid: Float[Array, "rows columns 2"], size: tuple[int, int]
) -> Float[Array, "rows columns 2"]:
    """The grid turned (never mirrored) into the board's own order, `size` = (columns, rows).

    Of the orders with that shape and x to y turning clockwise in the picture, as x right and y down do,
    those whose first square is black come first; among equals, the one whose x axis points
    most to the right.
    """
    columns, rows = size
    turned = [np.rot90(g, k) for g in (grid, grid.transpose(1, 0, 2)) for k in range(4)]
    orders = [g for g in turned if g.shape[:2] == (rows, columns) and _handedness(g) > 0]

    def preference(order: Float[Array, "rows columns 2"]) -> tuple[bool, float]:
        along = (order[:, -1] - order[:, 0]).sum(axis=0)
        return checker_agreement(grey, order) > 0, float(along[0] / np.linalg.norm(along))

    return np.ascontiguousarray(max(orders, key=preference))


def _handedness(grid: Float[Array, "rows columns 2"]) -> float:
    """Positive when x to y turns clockwise as seen in the picture (v down)."""
    x = (grid[:, -1] - grid[:, 0]).sum(axis=0)
    y = (grid[-1] - grid[0]).sum(axis=0)
    return float(x[0] * y[1] - x[1] * y[0])
