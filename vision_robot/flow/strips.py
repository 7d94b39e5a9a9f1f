"""Work in strips of rows that fit the cache, where several planes of a whole picture do not."""

from collections.abc import Iterator
from typing import NamedTuple

__all__ = ["Strip", "strips"]

PLANE_BYTES = 160_000
"""Most bytes of one plane of a strip; about ten planes are worked on at a time in a cache of 2 MB."""

FLOAT_BYTES = 4


class Strip(NamedTuple):
    """Rows [first, stop) of a picture, and the rows [low, high) that a stencil needs to know for them."""

    first: int
    stop: int
    low: int
    high: int

    @property
    def rows(self) -> slice:
        """The strip's own rows in the picture."""
        return slice(self.first, self.stop)

    @property
    def known(self) -> slice:
        """Its rows with their surroundings, in the picture."""
        return slice(self.low, self.high)

    @property
    def inner(self) -> slice:
        """Its own rows within `known`."""
        return slice(self.first - self.low, self.stop - self.low)


def strips(shape: tuple[int, int], reach: int = 0, *, crowd: int = 1) -> Iterator[Strip]:
    """Strips that cover a (height, width) picture, each but the last of an even number of rows.

    `reach` is how many rows away a pixel's result may depend on: the number of 3×3 stencils
    in a row. A picture that is not much larger than a strip is one strip. `crowd` is by how much
    more planes are at work than usual.
    """
    height, width = shape
    plane_bytes = PLANE_BYTES // crowd
    if height * width * FLOAT_BYTES <= 2 * plane_bytes:
        yield Strip(0, height, 0, height)
        return
    rows = max(8, plane_bytes // (FLOAT_BYTES * width) // 2 * 2)
    for first in range(0, height, rows):
        stop = min(first + rows, height)
        yield Strip(first, stop, max(first - reach, 0), min(stop + reach, height))
