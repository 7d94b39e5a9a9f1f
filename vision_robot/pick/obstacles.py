"""What else lies on the table: which grasps it leaves free, and what has to go first."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.errors import InTheWay
from vision_robot.geometry import WorkPlane
from vision_robot.pick.grasps import Grasp, Target, around
from vision_robot.pick.sighting import Seen, Sighting, sighting
from vision_robot.sim.fingers import Fingers
from vision_robot.sim.scatter import apart
from vision_robot.types import Array, Float

__all__ = ["Obstacle", "free_target", "obstacles_of"]

ROOM_M = 0.003
"""Kept between fingers and what is in the way: more than everything else may be wrong by."""

HEIGHT_M = 0.012
"""Height that is assumed of things whose shape is not known."""

RECTANGLE = np.sqrt(3) / 2
"""Side of a rectangle over the axis of the ellipse with the same second moments."""


@dataclass(frozen=True)
class Obstacle:
    """A blob taken for a rectangle on the table."""

    where: Sighting
    size_m: tuple[float, float]

    @property
    def corners(self) -> Float[Array, "4 2"]:
        """Of its outline in {S}."""
        half = np.array(self.size_m) / 2 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        c, s = np.cos(self.where.yaw_rad), np.sin(self.where.yaw_rad)
        return self.where.position_m + half @ np.array([[c, s], [-s, c]])


def obstacles_of(plane: WorkPlane, others: Sequence[Seen]) -> list[Obstacle]:
    """The blobs as rectangles on the table; those that look past it are left out."""
    found = []
    for seen in others:
        where = sighting(plane, seen, HEIGHT_M / 2)
        if not np.isfinite(where.position_m).all() or not np.isfinite(where.yaw_rad):
            continue
        side = np.array([-np.sin(seen.yaw_rad), np.cos(seen.yaw_rad)])
        if not np.isfinite(side).all():
            side = np.array([0.0, 1.0])
        ends = []
        for axis, length in ((np.array([side[1], -side[0]]), seen.major_px), (side, seen.minor_px)):
            pixels = seen.centroid_px + np.array([0.5, -0.5])[:, None] * length * axis
            places, _ = plane.measure(pixels, 0.5, z_m=HEIGHT_M / 2)
            ends.append(float(np.linalg.norm(places[0] - places[1])) * RECTANGLE)
        found.append(Obstacle(where, (ends[0], ends[1])))
    return found


def free_target(
    name: str,
    where: Sighting,
    grasps: Sequence[Grasp],
    symmetry_rad: float,
    fingers: Fingers,
    obstacles: Sequence[Obstacle],
) -> Target:
    """The first grasp whose fingers keep clear of all obstacles.

    Raises InTheWay, with the number of the obstacle that leaves the best grasp least room.
    """
    first: tuple[float, int] | None = None
    for grasp in grasps:
        target = Target(where, grasp, symmetry_rad)
        mine = around(target, fingers)
        rooms = [apart(mine, one.corners) for one in obstacles]
        if min(rooms, default=np.inf) >= ROOM_M:
            return target
        if first is None:
            first = min(rooms), int(np.argmin(rooms))
    assert first is not None, "there is at least one grasp"
    blocking = obstacles[first[1]].where.position_m
    raise InTheWay(name, blocking.tolist(), first[0], first[1])
