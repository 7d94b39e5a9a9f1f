"""The chessboard."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from vision_robot.calibrate.boards.board import Board
from vision_robot.calibrate.boards.drawing import Drawing, Polygon
from vision_robot.calibrate.boards.legend import legend
from vision_robot.calibrate.corners import Corners
from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float, Image

__all__ = ["Chessboard"]

FEWEST, MOST = 3, 200


@dataclass(frozen=True)
class Chessboard(Board):
    """Chessboard with `columns` × `rows` inner corners and squares of `square_m` [m].

    Ids are row-major: ``id = row * columns + column``. The square up and left of corner 0
    is black, and so the one down and right of it. With one count even and one odd (9×6),
    this fixes the board's frame in every picture. With both even or both odd the print looks the
    same after half a turn (and 8×8 after a quarter turn): of the orders that keep that
    square black, the one whose x axis points most to the right in the picture is taken.
    """

    columns: int
    rows: int
    square_m: float

    name: ClassVar[str] = "chessboard"

    def __post_init__(self) -> None:
        for name in ("columns", "rows"):
            count = getattr(self, name)
            if int(count) != count or not FEWEST <= count <= MOST:
                allowed = f"a whole number of inner corners from {FEWEST} to {MOST}"
                raise BadParameter(f"chessboard {name}", count, allowed)
            object.__setattr__(self, name, int(count))
        if not (np.isfinite(self.square_m) and self.square_m > 0):
            raise BadParameter("chessboard square", self.square_m, "a positive length in metres")
        object.__setattr__(self, "square_m", float(self.square_m))

    @classmethod
    def of_size(cls, size: tuple[int, int], square_m: float, **options: float | str) -> Self:
        """The chessboard with `size` = (columns, rows) inner corners; it has no other options."""
        if options:
            raise BadParameter("chessboard options", sorted(options), "none")
        return cls(*size, square_m)

    @property
    def points(self) -> Float[Array, "n 3"]:
        """Inner corners in the board frame [m], row by row."""
        row, column = np.divmod(np.arange(self.columns * self.rows), self.columns)
        return self.square_m * np.stack([column, row, np.zeros_like(row)], axis=1).astype(float)

    @property
    def size(self) -> str:
        """Inner corners, such as ``9x6``."""
        return f"{self.columns}x{self.rows}"

    @property
    def description(self) -> str:
        """Kind, inner corners and size of a square."""
        return f"chessboard {self.size} inner corners, squares {1000 * self.square_m:.6g} mm"

    @property
    def origin_m(self) -> tuple[float, float]:
        """The first inner corner lies one margin and one square from the page's corner."""
        return 2 * self.square_m, 2 * self.square_m

    @property
    def size_m(self) -> tuple[float, float]:
        """All squares and a quiet margin of one square on each side [m]."""
        return (self.columns + 3) * self.square_m, (self.rows + 3) * self.square_m

    def drawing(self) -> Drawing:
        """Black squares, the description and a scale bar below them."""
        s = self.square_m
        squares = tuple(
            Polygon.rectangle((column + 1) * s, (row + 1) * s, s, s)
            for row in range(self.rows + 1)
            for column in range(self.columns + 1)
            if (row + column) % 2 == 0
        )
        width, height = self.size_m
        bar, texts = legend(self.description, left=s, top=height - s, width=width - 2 * s, margin=s)
        return Drawing(width, height, squares + bar, texts)

    def detect(self, image: Image, *, name: str = "") -> Corners | None:
        """All inner corners, refined by a maximum-likelihood saddle fit, or None.

        Needs the whole board in view. The order keeps a right-handed frame as seen in the picture:
        a mirrored photo yields ids as if the board itself had been printed mirrored.
        """
        from vision_robot.calibrate.boards.chessboard_finder import find_chessboard

        return find_chessboard(image, (self.columns, self.rows), name=name)
