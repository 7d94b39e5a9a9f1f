"""Items at random places on the table, none upon another."""

from collections.abc import Sequence

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.sim.cell_design import Item
from vision_robot.sim.shapes import shape_named
from vision_robot.types import Array, Float

__all__ = ["scattered"]

Box = tuple[float, float, float, float]
ATTEMPTS = 400


def scattered(
    items: Sequence[Item],
    region_m: Box,
    rng: np.random.Generator,
    *,
    gap_m: float = 0.01,
    around: Sequence[Item] = (),
) -> list[Item]:
    """The items, lying at random inside `region_m` (least x, y, greatest x, y in {S}), any yaw.

    Middles lie in the region; outlines keep `gap_m` from each other and from those of `around`.
    Raises BadParameter where no room is found.
    """
    left, bottom, right, top = region_m
    taken = [outline(item, item.x_m, item.y_m, item.yaw_rad) for item in around]
    result = []
    for item in items:
        for _ in range(ATTEMPTS):
            x, y, yaw = rng.uniform(left, right), rng.uniform(bottom, top), rng.uniform(-np.pi, np.pi)
            mine = outline(item, x, y, yaw)
            if all(apart(mine, other) >= gap_m for other in taken):
                break
        else:
            raise BadParameter(
                f"{len(items)} items",
                region_m,
                f"fewer, or scattered over more room ({item.name} finds none)",
            )
        taken.append(mine)
        result.append(item.moved_to(x, y, yaw))
    return result


def outline(item: Item, x_m: float, y_m: float, yaw_rad: float) -> Float[Array, "4 2"]:
    """The rectangle around an item's footprint, lying there."""
    hull = shape_named(item.shape, item.size_m, item.colour).hull
    (left, bottom), (right, top) = hull[:, :2].min(axis=0), hull[:, :2].max(axis=0)
    corners = np.array([[left, bottom], [right, bottom], [right, top], [left, top]])
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    return corners @ np.array([[c, s], [-s, c]]) + (x_m, y_m)


def apart(one: Float[Array, "4 2"], other: Float[Array, "4 2"]) -> float:
    """A lower bound of the distance of two rectangles; negative where they overlap (separating axes)."""
    best = -np.inf
    for rectangle in (one, other):
        for edge in (rectangle[1] - rectangle[0], rectangle[2] - rectangle[1]):
            axis = edge / np.linalg.norm(edge)
            a, b = one @ axis, other @ axis
            best = max(best, b.min() - a.max(), a.min() - b.max())
    return float(best)
