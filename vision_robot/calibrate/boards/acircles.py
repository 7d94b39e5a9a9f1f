"""The asymmetric grid of circles."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from vision_robot.calibrate.boards.board import Board
from vision_robot.calibrate.boards.drawing import Disc, Drawing
from vision_robot.calibrate.boards.legend import legend
from vision_robot.calibrate.corners import Corners
from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float, Image, Int

__all__ = ["AsymmetricCircles"]

DEFAULT_RATIO = 0.7


@dataclass(frozen=True)
class AsymmetricCircles(Board):
    """OpenCV's asymmetric grid: `rows` rows of `columns` black discs, every other row shifted.

    Disc (row, column) lies at ``x = (2 * column + row % 2) * spacing_m``, ``y = row * spacing_m``:
    `spacing_m` [m] is the distance between rows, and half of that between neighbours in one row. Ids are
    row-major: ``id = row * columns + column``. OpenCV's usual 4×11 is ``columns=4, rows=11``.

    With an odd number of rows no turn carries the print into itself, and ids are unique in every picture.
    With an even number half a turn does: then the order whose x axis points most to the right
    in the picture is taken, as for a chessboard.

    What `detect` returns are the centres of the discs' outlines as seen. These are not where the discs'
    centres are seen: `vision_robot.calibrate.circle_bias` has the correction.
    """

    columns: int
    rows: int
    spacing_m: float
    diameter_m: float

    name: ClassVar[str] = "acircles"

    def __post_init__(self) -> None:
        for name in ("columns", "rows"):
            count = getattr(self, name)
            if int(count) != count or not 2 <= count <= 100:
                raise BadParameter(f"acircles {name}", count, "a whole number of circles from 2 to 100")
            object.__setattr__(self, name, int(count))
        if not (np.isfinite(self.spacing_m) and self.spacing_m > 0):
            raise BadParameter("acircles spacing", self.spacing_m, "a positive length in metres")
        if not 0.1 * self.spacing_m <= self.diameter_m <= 1.25 * self.spacing_m:
            allowed = "from 0.1 to 1.25 of the distance between rows"
            raise BadParameter("acircles diameter", self.diameter_m, allowed)

    @classmethod
    def of_size(cls, size: tuple[int, int], square_m: float, **options: float | str) -> Self:
        """The grid with `size` = (columns, rows) discs, `square_m` [m] from row to row.

        Option: `diameter_m` of a disc [m], by default 0.7 of that distance.
        """
        unknown = sorted(set(options) - {"diameter_m"})
        if unknown:
            raise BadParameter("acircles options", unknown, "diameter_m")
        return cls(*size, square_m, float(options.get("diameter_m", DEFAULT_RATIO * square_m)))

    @property
    def radius_m(self) -> float:
        """Radius of a disc [m]."""
        return self.diameter_m / 2

    @property
    def points(self) -> Float[Array, "n 3"]:
        """Centres in the board frame [m], row by row."""
        steps = self._steps()
        return self.spacing_m * np.column_stack([steps, np.zeros(len(steps))])

    @property
    def size(self) -> str:
        """Discs, such as ``4x11``."""
        return f"{self.columns}x{self.rows}"

    @property
    def description(self) -> str:
        """Kind, discs, spacing and diameter."""
        sizes = f"row distance {1000 * self.spacing_m:.6g} mm, diameter {1000 * self.diameter_m:.6g} mm"
        return f"circles {self.size} asymmetric, {sizes}"

    @property
    def origin_m(self) -> tuple[float, float]:
        """The first centre lies one and a half spacings from the page's corner."""
        return 1.5 * self.spacing_m, 1.5 * self.spacing_m

    @property
    def size_m(self) -> tuple[float, float]:
        """All discs and a quiet margin of one spacing around their cells [m]."""
        return (2 * self.columns + 2) * self.spacing_m, (self.rows + 2) * self.spacing_m

    def drawing(self) -> Drawing:
        """Black discs, the description and a scale bar below them."""
        s = self.spacing_m
        centres = self.points[:, :2] + self.origin_m
        discs = tuple(Disc((float(x), float(y)), self.radius_m) for x, y in centres)
        width, height = self.size_m
        bar, texts = legend(self.description, left=s, top=height - s, width=width - 2 * s, margin=s)
        return Drawing(width, height, discs + bar, texts)

    def detect(self, image: Image, *, name: str = "") -> Corners | None:
        """Centres of the discs' outlines, or None; the whole grid must be in view.

        Discs that cannot be measured (glare, something in front) are left out, up to a fifth.
        """
        from vision_robot.calibrate.boards.circle_grid import find_circles

        x, y = self._steps().T
        # Nearest neighbours lie along the diagonals: these are the lattice's axes.
        sites = np.stack([(x + y) // 2, (y - x) // 2], axis=1)
        return find_circles(image, sites, reach=np.sqrt(2) * self.spacing_m / self.diameter_m, name=name)

    def _steps(self) -> Int[Array, "n 2"]:
        """Positions in units of the spacing."""
        row, column = np.divmod(np.arange(self.columns * self.rows), self.columns)
        return np.stack([2 * column + row % 2, row], axis=1)
