"""The ways in which two fingers can take a thing whose shape is known."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import GripperTooNarrow
from vision_robot.geometry import SE3
from vision_robot.pick.episode import axis_angle
from vision_robot.pick.sighting import Sighting
from vision_robot.sim.cell_design import Item
from vision_robot.sim.fingers import Fingers
from vision_robot.sim.shapes import shape_named
from vision_robot.types import Array, Float

__all__ = ["Grasp", "Target", "around", "footprint_of", "grasps_of", "symmetry_of"]

CLEARANCES_M = (0.013, 0.006)
"""Of each finger from the thing before it closes: as much as errors want, then what little room leaves."""

OFF_MIDDLE = (0.0, 0.18, -0.18, 0.33, -0.33)
"""Shares of a thing's length at which it is taken; off the middle it tilts by its weight."""

FLOOR_M = 0.001
"""Between finger tips and table."""

SQUARE = 1.15
"""Ratio of a box's sides up to which a tracker cannot tell one from the other."""

TURNS_OF_A_DISC = 12


@dataclass(frozen=True)
class Grasp:
    """A grasp in the thing's own frame."""

    offset_m: tuple[float, float]
    """Of the tool from the thing's middle, along its x and y."""
    turn_rad: float
    """From the thing's x to the axis across which the fingers close."""
    width_m: float
    """Of the thing between the fingers."""
    opening_m: float
    """Gap of the fingers before they close."""
    height_m: float
    """Of the tool over the table."""

    @property
    def thing_from_axis(self) -> SE3:
        """The frame across whose x the fingers close, in the thing's."""
        return SE3.from_rotvec(np.array([0.0, 0.0, self.turn_rad]), np.array([*self.offset_m, 0.0]))


@dataclass(frozen=True)
class Target:
    """A thing where it was seen, and how it is to be taken."""

    where: Sighting
    grasp: Grasp
    symmetry_rad: float = np.pi
    """Turn after which the thing looks the same; 0: any."""

    @property
    def aim(self) -> Sighting:
        """Where the tool has to be: the grasp's place, axis and height."""
        return self.aim_at(self.where)

    def aim_at(self, where: Sighting) -> Sighting:
        """The same grasp of the thing lying elsewhere."""
        c, s = np.cos(where.yaw_rad), np.sin(where.yaw_rad)
        moved = np.array([[c, -s], [s, c]]) @ np.array(self.grasp.offset_m)
        return Sighting(
            where.position_m + moved,
            where.covariance_m2,
            where.yaw_rad + self.grasp.turn_rad,
            self.grasp.height_m,
        )

    def axis_of(self, station_from_thing: SE3) -> SE3:
        """Where the grasp really is, of the thing's equal orientations the one nearest to what was seen."""
        own, seen = axis_angle(station_from_thing.rotation, 0), self.where.yaw_rad
        off = seen - own
        step = self.symmetry_rad
        turn = off if step == 0 else step * np.round(off / step)
        alike = station_from_thing @ SE3.from_rotvec(np.array([0.0, 0.0, turn]), np.zeros(3))
        return alike @ self.grasp.thing_from_axis


def footprint_of(item: Item) -> tuple[float, float]:
    """Length and width on the table."""
    length, width = np.ptp(shape_named(item.shape, item.size_m, item.colour).hull[:, :2], axis=0).tolist()
    return length, width


def symmetry_of(item: Item) -> float:
    """The turn about its z after which the thing looks the same to a tracker [rad]; 0: any turn."""
    shape = shape_named(item.shape, item.size_m, item.colour)
    if not shape.has_yaw:
        return 0.0
    square = item.shape == "box" and max(item.size_m[:2]) < SQUARE * min(item.size_m[:2])
    return np.pi / 2 if square else np.pi


def grasps_of(item: Item, fingers: Fingers, most_m: float) -> list[Grasp]:
    """All grasps from above, the best first; `most_m` is the widest gap.

    Raises GripperTooNarrow where the fingers do not go around any side of it.
    """
    shape = shape_named(item.shape, item.size_m, item.colour)
    length, width = footprint_of(item)
    height = max(shape.rest_m, fingers.tip_m + FLOOR_M)
    sides = [(0.0, width, length), (np.pi / 2, length, width)]
    if not shape.has_yaw:
        sides = [(k * np.pi / TURNS_OF_A_DISC, width, 0.0) for k in range(TURNS_OF_A_DISC)]
    elif item.shape != "box":
        sides = sides[:1]  # nobody takes a rod by its ends
    found = []
    for clearance in CLEARANCES_M:
        for turn, across, along in sorted(sides, key=lambda side: side[1]):
            opening = across + 2 * clearance
            if opening > most_m:
                continue
            for share in OFF_MIDDLE if along > fingers.breadth_m else OFF_MIDDLE[:1]:
                offset = (share * along * np.cos(turn), share * along * np.sin(turn))
                found.append(Grasp(offset, turn, across, opening, height))
    if not found:
        narrowest = min(across for _, across, _ in sides)
        raise GripperTooNarrow(item.name, narrowest, most_m, CLEARANCES_M[-1])
    return sorted(found, key=lambda one: one.opening_m - one.width_m < 2 * CLEARANCES_M[0] - 1e-9)


def around(target: Target, fingers: Fingers) -> Float[Array, "4 2"]:
    """The rectangle of {S} that open fingers and what is between them take up."""
    aim = target.aim
    half = np.array([target.grasp.opening_m / 2 + fingers.thickness_m, fingers.breadth_m / 2])
    corners = half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    across = np.array([-np.sin(aim.yaw_rad), np.cos(aim.yaw_rad)])
    axes = np.stack([across, [np.cos(aim.yaw_rad), np.sin(aim.yaw_rad)]])
    return aim.position_m + corners @ axes
