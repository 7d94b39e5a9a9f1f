"""Shapes of the things on the table: what is drawn, what collides, and the hull that truth is told about.

All are convex, so that the outline in a picture is the convex hull of the projected hull points. Round
ones are drawn as the prisms of `SIDES` sides given here, not as MuJoCo's own cylinders: picture and
truth then speak of the very same body.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float

__all__ = ["SHAPES", "Collider", "Part", "Shape", "shape_named"]

Colour = tuple[float, float, float]

SIDES = 48
WOOD: Colour = (0.87, 0.72, 0.52)
GRAPHITE: Colour = (0.16, 0.16, 0.17)
WOODEN, PAPER = 650.0, 900.0
"""Densities [kg/m3]."""


@dataclass(frozen=True)
class Part:
    """A convex piece as it is drawn: its corners, in the item's frame [m], and its colour."""

    corners: Float[Array, "n 3"]
    colour: Colour


@dataclass(frozen=True)
class Collider:
    """A MuJoCo primitive for contacts: type, size and place in the item's frame."""

    kind: str
    """box, capsule, or mesh: the hull itself."""
    size: tuple[float, ...] = ()
    middle: tuple[float, float, float] = (0.0, 0.0, 0.0)
    along_x: bool = False
    """Whether the primitive's z is turned to the item's x."""


@dataclass(frozen=True)
class Shape:
    """A convex body about its own middle, x along its length, z up as it lies on the table."""

    parts: tuple[Part, ...]
    hull: Float[Array, "m 3"]
    colliders: tuple[Collider, ...]
    rest_m: float
    """Height of the middle over the table at rest."""
    density: float
    has_yaw: bool
    """Whether turning about z can be seen."""

    @property
    def reach_m(self) -> float:
        """Radius of the smallest upright cylinder about the middle that holds the body."""
        return float(np.linalg.norm(self.hull[:, :2], axis=1).max())


@lru_cache(maxsize=512)
def shape_named(name: str, size_m: tuple[float, ...], colour: Colour) -> Shape:
    """The shape of that name; raises BadParameter for an unknown one or an impossible size."""
    if name not in SHAPES:
        raise BadParameter("shape", name, f"one of {', '.join(SHAPES)}")
    numbers, make = SHAPES[name]
    size = tuple(float(value) for value in size_m)
    if len(size) != len(numbers) or not all(0.001 <= value <= 2 for value in size):
        raise BadParameter(f"size of a {name}", size_m, f"({', '.join(numbers)}) from 0.001 to 2 m")
    return make(size, colour)


def _ring(x: float, radius: float, sides: int, turn: float = 0.0) -> Float[Array, "sides 3"]:
    """A regular polygon across the x axis, `radius` to its corners."""
    angle = turn + 2 * np.pi * np.arange(sides) / sides
    return np.stack([np.full(sides, x), radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def _pencil(size: tuple[float, ...], colour: Colour) -> Shape:
    """A hexagonal pencil, sharpened at +x, dipped in white at -x; `diameter` is across its flats.

    Its cone is six-sided, which keeps the whole convex.
    """
    length, diameter = size
    if length < 6 * diameter:
        raise BadParameter("length of a pencil", length, f"at least 6 diameters, {6 * diameter:g} m")
    outer, half = diameter / np.sqrt(3), length / 2
    shoulder, lead, cap = half - 2.6 * diameter, half - 0.75 * diameter, -half + 1.2 * diameter
    point = outer * 0.04
    narrow = point + (outer - point) * 0.75 / 2.6  # on the straight line from shoulder to point
    rings = [
        _ring(x, r, 6)
        for x, r in ((-half, outer), (cap, outer), (shoulder, outer), (lead, narrow), (half, point))
    ]
    colours: tuple[Colour, ...] = ((0.93, 0.93, 0.9), colour, WOOD, GRAPHITE)
    parts = [Part(np.concatenate(rings[i : i + 2]), colours[i]) for i in range(4)]
    hull = np.concatenate([rings[0], rings[2], rings[4]])
    return Shape(tuple(parts), hull, (Collider("mesh"),), diameter / 2, WOODEN, has_yaw=True)


def _hexagon(size: tuple[float, ...], colour: Colour) -> Shape:
    """A hexagonal rod of one colour; `diameter` is across its flats."""
    length, diameter = size
    hull = np.concatenate([_ring(x, diameter / np.sqrt(3), 6) for x in (-length / 2, length / 2)])
    return Shape((Part(hull, colour),), hull, (Collider("mesh"),), diameter / 2, WOODEN, has_yaw=True)


def _rod(size: tuple[float, ...], colour: Colour) -> Shape:
    """A round rod of one colour."""
    length, diameter = size
    if length < 1.5 * diameter:
        raise BadParameter("length of a rod", length, f"at least 1.5 diameters, {1.5 * diameter:g} m")
    hull = np.concatenate([_ring(x, diameter / 2, SIDES) for x in (-length / 2, length / 2)])
    capsule = Collider("capsule", (diameter / 2, (length - diameter) / 2), along_x=True)
    return Shape((Part(hull, colour),), hull, (capsule,), diameter / 2, WOODEN, has_yaw=True)


def _box(size: tuple[float, ...], colour: Colour) -> Shape:
    half = np.array(size) / 2
    hull = half * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return Shape(
        (Part(hull, colour),),
        hull,
        (Collider("box", tuple(half.tolist())),),
        size[2] / 2,
        PAPER,
        has_yaw=True,
    )


def _disc(size: tuple[float, ...], colour: Colour) -> Shape:
    diameter, thickness = size
    rings = [_ring(z, diameter / 2, SIDES)[:, [1, 2, 0]] for z in (-thickness / 2, thickness / 2)]
    hull = np.concatenate(rings)
    return Shape((Part(hull, colour),), hull, (Collider("mesh"),), thickness / 2, PAPER, has_yaw=False)


SHAPES: dict[str, tuple[tuple[str, ...], Callable[[tuple[float, ...], Colour], Shape]]] = {
    "pencil": (("length", "diameter"), _pencil),
    "rod": (("length", "diameter"), _rod),
    "hexagon": (("length", "diameter"), _hexagon),
    "box": (("x", "y", "z"), _box),
    "disc": (("diameter", "thickness"), _disc),
}
"""Names of the numbers that make up the size, and what makes the shape."""
