"""The ChArUco board: a chessboard with a marker in every white square."""

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

__all__ = ["Charuco"]

DEFAULT_DICTIONARY = "DICT_5X5_100"
DEFAULT_RATIO = 0.7


@dataclass(frozen=True)
class Charuco(Board):
    """ChArUco board of `columns` × `rows` SQUARES of `square_m` [m], as ``cv2.aruco.CharucoBoard``.

    Its points are the (columns - 1) × (rows - 1) inner corners, ids row-major as OpenCV's. A marker's
    side is `marker_ratio` of a square's; marker 0 is the first of `dictionary`. The square at the top left
    is black, save with `legacy` and an even number of rows, where it is white as OpenCV drew it before 4.6.
    """

    columns: int
    rows: int
    square_m: float
    marker_ratio: float = DEFAULT_RATIO
    dictionary: str = DEFAULT_DICTIONARY
    legacy: bool = False

    name: ClassVar[str] = "charuco"
    allows_partial_views: ClassVar[bool] = True

    def __post_init__(self) -> None:
        for name in ("columns", "rows"):
            count = getattr(self, name)
            if int(count) != count or not 3 <= count <= 200:
                raise BadParameter(f"charuco {name}", count, "a whole number of squares from 3 to 200")
            object.__setattr__(self, name, int(count))
        if not (np.isfinite(self.square_m) and self.square_m > 0):
            raise BadParameter("charuco square", self.square_m, "a positive length in metres")
        if not 0.3 <= self.marker_ratio <= 0.9:
            raise BadParameter("marker ratio", self.marker_ratio, "from 0.3 to 0.9 of a square")
        markers = len(dictionary_named(self.dictionary).bytesList)
        if self.columns * self.rows // 2 > markers:
            needed = f"one with at least {self.columns * self.rows // 2} markers (it has {markers})"
            raise BadParameter("dictionary", self.dictionary, needed)

    @classmethod
    def of_size(cls, size: tuple[int, int], square_m: float, **options: float | str) -> Self:
        """The board with `size` = (columns, rows) squares.

        Options: `dictionary` (such as DICT_5X5_100), `marker_ratio` (marker's side / square's side) and
        `legacy` (0 or 1).
        """
        unknown = sorted(set(options) - {"dictionary", "marker_ratio", "legacy"})
        if unknown:
            raise BadParameter("charuco options", unknown, "dictionary, marker_ratio, legacy")
        return cls(
            *size,
            square_m,
            marker_ratio=float(options.get("marker_ratio", DEFAULT_RATIO)),
            dictionary=str(options.get("dictionary", DEFAULT_DICTIONARY)),
            legacy=bool(float(options.get("legacy", 0))),
        )

    @property
    def points(self) -> Float[Array, "n 3"]:
        """Inner corners in the board frame [m], row by row."""
        row, column = np.divmod(np.arange((self.columns - 1) * (self.rows - 1)), self.columns - 1)
        return self.square_m * np.stack([column, row, np.zeros_like(row)], axis=1).astype(float)

    @property
    def size(self) -> str:
        """Squares, such as ``9x6``."""
        return f"{self.columns}x{self.rows}"

    @property
    def description(self) -> str:
        """Kind, squares and inner corners, sizes and dictionary."""
        sizes = f"squares {1000 * self.square_m:.6g} mm, markers {1000 * self.marker_m:.6g} mm"
        corners = f"{self.columns - 1}x{self.rows - 1} inner corners"
        legacy = ", legacy" if self.legacy else ""
        return f"ChArUco {self.size} squares ({corners}), {sizes}, {self.dictionary}{legacy}"

    @property
    def marker_m(self) -> float:
        """Side of a marker [m]."""
        return self.marker_ratio * self.square_m

    @property
    def origin_m(self) -> tuple[float, float]:
        """The first inner corner lies one margin and one square from the page's corner."""
        return 2 * self.square_m, 2 * self.square_m

    @property
    def size_m(self) -> tuple[float, float]:
        """All squares and a quiet margin of one square on each side [m]."""
        return (self.columns + 2) * self.square_m, (self.rows + 2) * self.square_m

    def drawing(self) -> Drawing:
        """Black squares, markers, the description and a scale bar below them."""
        s, inset = self.square_m, (self.square_m - self.marker_m) / 2
        dictionary = dictionary_named(self.dictionary)
        shapes = [
            Polygon.rectangle((column + 1) * s, (row + 1) * s, s, s)
            for row in range(self.rows)
            for column in range(self.columns)
            if self._is_black(row, column)
        ]
        for marker, (row, column) in enumerate(self._white_squares()):
            left, top = (column + 1) * s + inset, (row + 1) * s + inset
            shapes += marker_shapes(marker_bits(dictionary, marker), left=left, top=top, side=self.marker_m)
        width, height = self.size_m
        bar, texts = legend(self.description, left=s, top=height - s, width=width - 2 * s, margin=s)
        return Drawing(width, height, (*shapes, *bar), texts)

    def detect(self, image: Image, *, name: str = "") -> Corners | None:
        """Inner corners next to a marker that is seen, or None where fewer than two markers are.

        Parts of the board are enough: ids name the corners. Markers of the dictionary that do not
        lie as they do on this board are ignored, so a board of another width is not taken for this one.
        """
        from vision_robot.calibrate.boards.chessboard_finder import grey_of

        grey = grey_of(image)
        corners = self._marker_corners()
        markers = find_markers(grey, dictionary_named(self.dictionary), corners)
        if not len(markers):
            return None
        return coded_corners(grey, markers, corners, self._sites(), name=name)

    def _is_black(self, row: int, column: int) -> bool:
        starts_white = self.legacy and self.rows % 2 == 0
        return (row + column + starts_white) % 2 == 0

    def _white_squares(self) -> list[tuple[int, int]]:
        cells = [(row, column) for row in range(self.rows) for column in range(self.columns)]
        return [(row, column) for row, column in cells if not self._is_black(row, column)]

    def _marker_corners(self) -> Float[Array, "m 4 2"]:
        """Corners of the markers in the board frame [m]: top left, top right, bottom right, bottom left."""
        square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * self.marker_m / 2
        centres = np.array([(column - 0.5, row - 0.5) for row, column in self._white_squares()])
        return self.square_m * centres[:, None] + square

    def _sites(self) -> CornerSites:
        points = self.points
        column, row = np.rint(points[:, :2] / self.square_m).astype(int).T
        starts_white = self.legacy and self.rows % 2 == 0
        # The square down and right of inner corner (row, column) is square (row + 1, column + 1).
        dark = (row + column + starts_white) % 2 == 0
        nearest_marker = np.sqrt(2) * (self.square_m - self.marker_m) / 2
        return CornerSites(points[:, :2], nearest_marker, dark)
