"""Square binary markers of OpenCV's dictionaries, as shapes to print."""

import cv2
import numpy as np

from vision_robot.calibrate.boards.drawing import Polygon
from vision_robot.errors import BadParameter
from vision_robot.types import Array, Bool

__all__ = ["DICTIONARIES", "dictionary_named", "marker_bits", "marker_shapes"]

DICTIONARIES = tuple(name for name in sorted(dir(cv2.aruco)) if name.startswith("DICT_") and name.isupper())
"""Names of the dictionaries OpenCV knows."""


def dictionary_named(name: str) -> cv2.aruco.Dictionary:
    """OpenCV's dictionary of that name, such as ``DICT_5X5_100`` or ``5x5_100``; BadParameter if unknown."""
    wanted = str(name).upper()
    wanted = wanted if wanted.startswith("DICT_") else f"DICT_{wanted}"
    if wanted not in DICTIONARIES:
        raise BadParameter("dictionary", name, f"one of {', '.join(DICTIONARIES)}")
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, wanted))


def marker_bits(dictionary: cv2.aruco.Dictionary, marker: int) -> Bool[Array, "k k"]:
    """Which cells inside the border of one marker are white, upright as OpenCV draws it."""
    cells = dictionary.markerSize
    # One picture pixel a cell, border of one cell cut off.
    return cv2.aruco.generateImageMarker(dictionary, marker, cells + 2)[1:-1, 1:-1] > 0


def marker_shapes(
    white: Bool[Array, "k k"], *, left: float, top: float, side: float, border_bits: int = 1
) -> tuple[Polygon, ...]:
    """A black square of `side` [m] at (left, top) [m] with its white cells painted on it.

    White regions are drawn by their outlines and the black islands in them on top, so that no seam
    between cells shows in print.
    """
    cell = side / (len(white) + 2 * border_bits)
    shapes = [Polygon.rectangle(left, top, side, side)]
    for loop, is_white in _outlines(white):
        vertices = tuple((left + (x + border_bits) * cell, top + (y + border_bits) * cell) for x, y in loop)
        shapes.append(Polygon(vertices, black=not is_white))
    return tuple(shapes)


Loop = list[tuple[int, int]]


def _outlines(white: Bool[Array, "k k"]) -> list[tuple[Loop, bool]]:
    """Outlines of the white regions (True) and of the islands in them (False), the outer first.

    Edges run with white on their right (y down): an outline turns clockwise and a hole the other way, and
    the number of turns around a cell, outlines less holes, is one where it is white.
    """
    heads: dict[tuple[int, int], list[tuple[int, int]]] = {}
    padded = np.pad(white, 1)
    for row, column in np.argwhere(white).tolist():
        corners = [(column, row), (column + 1, row), (column + 1, row + 1), (column, row + 1)]
        for side, (dx, dy) in enumerate([(0, -1), (1, 0), (0, 1), (-1, 0)]):
            if not padded[row + 1 + dy, column + 1 + dx]:
                heads.setdefault(corners[side], []).append(corners[(side + 1) % 4])
    loops = []
    while heads:
        start = next(iter(heads))
        loop, here, direction = [start], start, (0, 0)
        while True:
            # Where two regions touch at a corner, keep to one of them by turning right.
            options = heads[here]
            right = (here[0] - direction[1], here[1] + direction[0])
            there = options.pop(options.index(right) if right in options else 0)
            if not options:
                del heads[here]
            direction = (there[0] - here[0], there[1] - here[1])
            here = there
            if here == start:
                break
            loop.append(here)
        loops.append(_without_straight_vertices(loop))
    areas = [_area(loop) for loop in loops]
    order = sorted(range(len(loops)), key=lambda k: -abs(areas[k]))
    return [(loops[k], areas[k] > 0) for k in order]


def _without_straight_vertices(loop: Loop) -> Loop:
    before, after = loop[-1:] + loop[:-1], loop[1:] + loop[:1]
    triples = zip(before, loop, after, strict=True)
    return [here for b, here, a in triples if not (b[0] == here[0] == a[0] or b[1] == here[1] == a[1])]


def _area(loop: Loop) -> float:
    """Signed area; positive when clockwise as seen with y down."""
    x, y = np.array(loop, dtype=float).T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
