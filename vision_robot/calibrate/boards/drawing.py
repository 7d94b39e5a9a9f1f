"""What a target looks like on paper, apart from any file format."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float

__all__ = ["Disc", "Drawing", "Polygon", "TextLine"]


@dataclass(frozen=True)
class Polygon:
    """Filled polygon: page positions (x right, y down from the page's top-left corner) [m], ink 1 or 0."""

    vertices: tuple[tuple[float, float], ...]
    black: bool = True

    @classmethod
    def rectangle(
        cls, left: float, top: float, width: float, height: float, *, black: bool = True
    ) -> "Polygon":
        """Upright rectangle [m]."""
        right, bottom = left + width, top + height
        return cls(((left, top), (right, top), (right, bottom), (left, bottom)), black)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Left, top, right, bottom [m]."""
        x, y = zip(*self.vertices, strict=True)
        return min(x), min(y), max(x), max(y)

    @property
    def is_rectangle(self) -> bool:
        """Whether it is an upright rectangle, whose cover of a pixel is a product."""
        left, top, right, bottom = self.bounds
        box = {(left, top), (right, top), (right, bottom), (left, bottom)}
        return len(self.vertices) == 4 and set(self.vertices) == box

    def crossings(self, y: Float[Array, "n"]) -> Float[Array, "n k"]:
        """Where the outline meets horizontal lines, sorted along x; NaN-padded, entry and exit in turn."""
        a = np.array(self.vertices, dtype=float)
        b = np.roll(a, -1, axis=0)
        rows = np.asarray(y, dtype=float)[:, None]
        meets = (a[:, 1] <= rows) != (b[:, 1] <= rows)
        rise = np.where(b[:, 1] == a[:, 1], 1.0, b[:, 1] - a[:, 1])
        x = a[:, 0] + (rows - a[:, 1]) * (b[:, 0] - a[:, 0]) / rise
        return np.sort(np.where(meets, x, np.nan), axis=1)


@dataclass(frozen=True)
class Disc:
    """Filled disc: centre on the page and radius [m]."""

    centre: tuple[float, float]
    radius: float
    black: bool = True

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Left, top, right, bottom [m]."""
        (x, y), r = self.centre, self.radius
        return x - r, y - r, x + r, y + r

    def crossings(self, y: Float[Array, "n"]) -> Float[Array, "n 2"]:
        """Where the outline meets horizontal lines; NaN where it does not."""
        with np.errstate(invalid="ignore"):
            half = np.sqrt(self.radius**2 - (np.asarray(y, dtype=float) - self.centre[1]) ** 2)
        return np.stack([self.centre[0] - half, self.centre[0] + half], axis=1)


@dataclass(frozen=True)
class TextLine:
    """One line of print: left end of the base line on the page and height of a capital [m]."""

    text: str
    left: float
    base: float
    height: float


@dataclass(frozen=True)
class Drawing:
    """A white page of `width` × `height` [m] with shapes painted on it in order, and text.

    Black shapes do not overlap one another, and a white shape lies inside one black shape:
    so ink simply adds, and rasters are exact.
    """

    width: float
    height: float
    shapes: tuple[Polygon | Disc, ...]
    texts: tuple[TextLine, ...] = ()

    def __post_init__(self) -> None:
        if not (np.isfinite([self.width, self.height]).all() and min(self.width, self.height) > 0):
            raise BadParameter("drawing size", (self.width, self.height), "positive lengths in metres")

    @property
    def ink_bounds(self) -> tuple[float, float, float, float]:
        """Left, top, right, bottom [m] of all shapes, and of the texts' base lines."""
        if not self.shapes:
            return 0.0, 0.0, self.width, self.height
        left, top, right, bottom = np.array([shape.bounds for shape in self.shapes]).T
        low = [bottom.max(), *(line.base + 0.3 * line.height for line in self.texts)]
        return float(left.min()), float(top.min()), float(right.max()), float(max(low))

    def moved(self, dx: float, dy: float, *, page: tuple[float, float]) -> "Drawing":
        """The same ink shifted by (dx, dy) on a page of another size [m]."""
        shapes = tuple(
            Polygon(tuple((x + dx, y + dy) for x, y in shape.vertices), shape.black)
            if isinstance(shape, Polygon)
            else Disc((shape.centre[0] + dx, shape.centre[1] + dy), shape.radius, shape.black)
            for shape in self.shapes
        )
        texts = tuple(TextLine(t.text, t.left + dx, t.base + dy, t.height) for t in self.texts)
        return Drawing(*page, shapes, texts)
