"""Kalibr's AprilGrid: AprilTags in a grid with small black squares at their corners."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from vision_robot.calibrate.boards.board import Board
from vision_robot.calibrate.boards.coded_corners import CornerSites, coded_corners
from vision_robot.calibrate.boards.drawing import Drawing, Polygon
from vision_robot.calibrate.boards.legend import legend
from vision_robot.calibrate.boards.marker import dictionary_named, marker_bits, marker_shapes
from vision_robot.calibrate.boards.marker_finder import find_markers
from vision_robot.calibrate.corners import Corners
from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float, Image

__all__ = ["AprilGrid"]

DICTIONARY = "DICT_APRILTAG_36H11"
BORDER_BITS = 2
"""Kalibr prints tags with a black border of two cells (kalibr_create_target_pdf, borderBits)."""

CELLS = 6 + 2 * BORDER_BITS
DEFAULT_SPACING = 0.3


@dataclass(frozen=True)
class AprilGrid(Board):
    """Kalibr's target of `columns` × `rows` tags (36h11) of side `tag_m` [m], black border included.

    `spacing` is the gap between tags as a share of their side, Kalibr's tagSpacing. The print is that of
    kalibr_create_target_pdf: tag 0 is at the BOTTOM left, ids run right and then up, the tags stand upright,
    and a black square fills each crossing of gaps, so that every tag corner is a saddle.

    Points are numbered as in Kalibr's GridCalibrationTargetAprilgrid: a grid of 2 columns × 2 rows
    corners, row by row from the bottom, ``id = 2 * columns * row + column``. The board frame has its
    origin at point 0 like Kalibr's, but y down and z into the board as all boards here: ``(x, y, z)`` is
    Kalibr's ``(x, -y, -z)``, and so the points have y ≤ 0.
    """

    columns: int
    rows: int
    tag_m: float
    spacing: float = DEFAULT_SPACING

    name: ClassVar[str] = "aprilgrid"
    allows_partial_views: ClassVar[bool] = True

    def __post_init__(self) -> None:
        for name in ("columns", "rows"):
            count = getattr(self, name)
            if int(count) != count or not 1 <= count <= 200:
                raise BadParameter(f"aprilgrid {name}", count, "a whole number of tags from 1 to 200")
            object.__setattr__(self, name, int(count))
        available = len(dictionary_named(DICTIONARY).bytesList)
        if not 2 <= self.columns * self.rows <= available:
            raise BadParameter("aprilgrid size", self.size, f"from 2 to {available} tags in all")
        if not (np.isfinite(self.tag_m) and self.tag_m > 0):
            raise BadParameter("aprilgrid tag", self.tag_m, "a positive length in metres")
        if not 0.05 <= self.spacing <= 1:
            raise BadParameter(
                "aprilgrid spacing", self.spacing, "from 0.05 to 1, as a share of a tag's side"
            )

    @classmethod
    def of_size(cls, size: tuple[int, int], square_m: float, **options: float | str) -> Self:
        """The grid with `size` = (columns, rows) tags of side `square_m` [m].

        Option: `spacing`, the gap between tags as a share of their side (Kalibr's tagSpacing).
        """
        unknown = sorted(set(options) - {"spacing"})
        if unknown:
            raise BadParameter("aprilgrid options", unknown, "spacing")
        return cls(*size, square_m, spacing=float(options.get("spacing", DEFAULT_SPACING)))

    @property
    def points(self) -> Float[Array, "n 3"]:
        """Tag corners in the board frame [m], in Kalibr's order."""
        up, right = np.divmod(np.arange(4 * self.columns * self.rows), 2 * self.columns)
        x, y = ((i // 2) * self._pitch + (i % 2) * self.tag_m for i in (right, up))
        return np.stack([x, -y, np.zeros_like(x)], axis=1)

    @property
    def size(self) -> str:
        """Tags, such as ``6x6``."""
        return f"{self.columns}x{self.rows}"

    @property
    def description(self) -> str:
        """Kind, tags, sizes and family."""
        return f"AprilGrid {self.size} tags 36h11, {1000 * self.tag_m:.6g} mm, spacing {self.spacing:.6g}"

    @property
    def origin_m(self) -> tuple[float, float]:
        """The bottom left corner of the lowest left tag, from the page's top-left corner [m]."""
        left = self._margin + self._gap
        return left, left + self.rows * self._pitch - self._gap

    @property
    def size_m(self) -> tuple[float, float]:
        """Tags, the outer squares and a quiet margin of half a tag on each side [m]."""
        extra = 2 * self._margin + self._gap
        return self.columns * self._pitch + extra, self.rows * self._pitch + extra

    def drawing(self) -> Drawing:
        """Tags, corner squares, the description and a scale bar below them."""
        dictionary = dictionary_named(DICTIONARY)
        left, bottom = self.origin_m
        shapes = [
            Polygon.rectangle(
                left + i * self._pitch - self._gap, bottom - j * self._pitch, self._gap, self._gap
            )
            for j in range(self.rows + 1)
            for i in range(self.columns + 1)
        ]
        for tag in range(self.columns * self.rows):
            row, column = divmod(tag, self.columns)
            # OpenCV keeps this family half a turn from the way AprilTag's makers and Kalibr print it.
            bits = np.rot90(marker_bits(dictionary, tag), 2)
            x, y = left + column * self._pitch, bottom - row * self._pitch - self.tag_m
            shapes += marker_shapes(bits, left=x, top=y, side=self.tag_m, border_bits=BORDER_BITS)
        width, height = self.size_m
        room = self._margin
        bar, texts = legend(
            self.description, left=room, top=height - room, width=width - 2 * room, margin=room
        )
        return Drawing(width, height, (*shapes, *bar), texts)

    def detect(self, image: Image, *, name: str = "") -> Corners | None:
        """Corners of the tags that are seen, or None where fewer than two are.

        Parts of the grid are enough: ids name the corners. Tags that do not lie as they do on this grid
        are ignored, so a grid of another width is not taken for this one.
        """
        from vision_robot.calibrate.boards.chessboard_finder import grey_of

        grey = grey_of(image)
        corners = self._marker_corners()
        markers = find_markers(grey, dictionary_named(DICTIONARY), corners, border_bits=BORDER_BITS)
        if not len(markers):
            return None
        return coded_corners(grey, markers, corners, self._sites(), name=name)

    @property
    def _gap(self) -> float:
        return self.spacing * self.tag_m

    @property
    def _pitch(self) -> float:
        return (1 + self.spacing) * self.tag_m

    @property
    def _margin(self) -> float:
        return self.tag_m / 2

    def _marker_corners(self) -> Float[Array, "m 4 2"]:
        """Corners of the tags in the board frame [m], in the order of OpenCV's upright picture.

        That picture's top left is the printed tag's bottom right.
        """
        square = self.tag_m * np.array([[1, 0], [0, 0], [0, -1], [1, -1]])
        row, column = np.divmod(np.arange(self.columns * self.rows), self.columns)
        return self._pitch * np.stack([column, -row], axis=1)[:, None] + square

    def _sites(self) -> CornerSites:
        points = self.points[:, :2]
        up, right = np.divmod(np.arange(len(points)), 2 * self.columns)
        # The next edges are the far sides of the gap and the first cell inside the tag's border.
        clear = min(self.spacing, np.sqrt(2) * BORDER_BITS / CELLS) * self.tag_m
        # The tag lies up and right of its lower left corner: black there and in the quadrant opposite.
        return CornerSites(points, float(clear), (up + right) % 2 == 1)
