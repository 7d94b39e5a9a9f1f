"""Before the arm goes for a thing: seeing it, choosing a grasp, and putting aside what is in the way."""

from dataclasses import dataclass, field, replace

import numpy as np

from vision_robot.errors import InTheWay
from vision_robot.pick.episode import Episode, axis_angle
from vision_robot.pick.grasps import (
    CLEARANCES_M,
    FLOOR_M,
    OFF_MIDDLE,
    Grasp,
    Target,
    footprint_of,
    grasps_of,
    symmetry_of,
)
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.look import LIES, Eye, survey
from vision_robot.pick.obstacles import HEIGHT_M, Obstacle, free_target, obstacles_of
from vision_robot.pick.open_loop import Hand
from vision_robot.pick.player import Player
from vision_robot.pick.sighting import Sighting, sighting
from vision_robot.sim.cell_design import Item
from vision_robot.sim.fingers import Fingers
from vision_robot.sim.scatter import apart, outline
from vision_robot.track.tracker import Tracker

__all__ = ["Attempt"]

MOST_CLEARED = 3
"""Things that are put aside before the thing itself is given up."""

ASIDE_M, FAR_M = 0.015, 0.040
"""Kept around what is put aside; and from the thing, which fingers need to come down beside."""


@dataclass
class Attempt:
    """Eye, tracker and arm of one episode, with what its controller believes."""

    eye: Eye
    player: Player
    believed: Knowledge
    tracker: Tracker
    true_tracking: bool = False
    obstacles: list[Obstacle] = field(default_factory=list)

    def __post_init__(self) -> None:
        fingers = self.player.cell.fingers
        assert fingers is not None, "an arm with a gripper"
        self.fingers: Fingers = fingers
        self.item: Item = self.player.world.design.items[0]
        self.waiting = self.player.joints
        """Where the arm waits and hides nothing."""

    def found(self, *, again: bool = False) -> Sighting:
        """The thing and, in `obstacles`, all else, by a look at the table. Raises NothingSeen."""
        cell, world = self.player.cell, self.player.world
        if again:
            self.player.move_to(self.waiting)
        arrival = LIES if again else None
        seen = survey(cell, self.eye, self.tracker, self.item.name, world, arrival, self.believed.plane)
        thing = self.eye.truth_of(self.item.name) if self.true_tracking else seen.thing
        self.obstacles = obstacles_of(self.believed.plane, seen.others)
        return sighting(self.believed.plane, thing, self.item_height_m)

    @property
    def item_height_m(self) -> float:
        """Of its middle over the table, known from its size."""
        return self.item.size_m[-1] / 2

    @property
    def grasps(self) -> list[Grasp]:
        """All grasps of the thing. Raises GripperTooNarrow."""
        return grasps_of(self.item, self.fingers, self.player.cell.opening_limits_m[1])

    def seen(self, episode: Episode, where: Sighting) -> Episode:
        """The episode with how well the thing was seen."""
        there = episode.station_from_object
        off = where.position_m - there.translation[:2]
        half = symmetry_of(self.item) / 2
        turn = where.yaw_rad - axis_angle(there.rotation, 0)
        yaw = float((turn + half) % (2 * half) - half) if half else np.nan
        return replace(episode, seen_error_m=float(np.linalg.norm(off)), seen_yaw_error_rad=yaw)

    def free(self, where: Sighting) -> tuple[Target, int]:
        """A grasp that keeps clear of all else, and how many things had to be put aside for it.

        Raises InTheWay where that does not help, GripperTooNarrow and Unreachable.
        """
        for cleared in range(MOST_CLEARED + 1):
            try:
                name, turn = self.item.name, symmetry_of(self.item)
                found = free_target(name, where, self.grasps, turn, self.fingers, self.obstacles)
                return found, cleared
            except InTheWay as blocked:
                if cleared == MOST_CLEARED:
                    raise
                self._put_aside(blocked, where)
            where = self.found(again=True)
        raise AssertionError("the last round returns or raises")

    def _put_aside(self, blocked: InTheWay, where: Sighting) -> None:
        """Put aside one thing whose going frees a grasp, else what blocks the best one.

        Raises InTheWay where it cannot be taken itself, or has no room elsewhere.
        """
        thing = Obstacle(where, footprint_of(self.item))
        for index in [*self._whose_going_helps(where), blocked.which]:
            one = self.obstacles[index]
            rest = [thing, *(other for k, other in enumerate(self.obstacles) if k != index)]
            aside = self._room(one, rest)
            try:
                own = free_target("", one.where, self._rough_grasps(one), np.pi, self.fingers, rest)
            except InTheWay:
                continue
            if aside is not None:
                return self._moved(own, aside)
        raise blocked

    def _whose_going_helps(self, where: Sighting) -> list[int]:
        """Obstacles without any one of which there would be a free grasp."""
        found = []
        for index in range(len(self.obstacles)):
            rest = [other for k, other in enumerate(self.obstacles) if k != index]
            try:
                free_target("", where, self.grasps, symmetry_of(self.item), self.fingers, rest)
            except InTheWay:
                continue
            found.append(index)
        return found

    def _rough_grasps(self, one: Obstacle) -> list[Grasp]:
        """Grasps across the narrow side of a thing whose shape is not known."""
        length, width = one.size_m
        height = max(HEIGHT_M / 2, self.fingers.tip_m + FLOOR_M)
        most = self.player.cell.opening_limits_m[1]
        found = [
            Grasp((share * length, 0.0), 0.0, width, width + 2 * clearance, height)
            for clearance in CLEARANCES_M
            for share in OFF_MIDDLE
        ]
        fits = [one for one in found if one.opening_m <= most]
        return fits or [replace(found[-1], opening_m=np.inf)]  # which no room is enough for

    def _moved(self, own: Target, aside: Sighting) -> None:
        hand = Hand(self.player, self.believed)
        self.player.phase = "clear"
        self.player.grip(own.grasp.opening_m, seconds=0.2)
        hand.down_on(own.aim)
        hand.close()
        hand.up_from(own.aim)
        hand.put_down(hand.aim_for(own, aside), own.grasp.opening_m)

    def _room(self, one: Obstacle, others: list[Obstacle]) -> Sighting | None:
        """The nearest place clear of `others`, first of which is the thing, and of where that is to go."""
        x, y, yaw = self.player.world.place
        goal = outline(self.item, x, y, yaw)
        left, bottom, right, top = self.player.world.design.scatter_m
        places = np.stack(np.meshgrid(np.linspace(left, right, 9), np.linspace(bottom, top, 11)), axis=-1)
        flat = places.reshape(-1, 2)
        order = np.argsort(np.linalg.norm(flat - one.where.position_m, axis=1))
        for place in flat[order]:
            moved = replace(one, where=replace(one.where, position_m=place))
            rooms = [apart(moved.corners, other.corners) for other in others]
            clear = min(*rooms[1:], apart(moved.corners, goal), np.inf) >= ASIDE_M
            if clear and rooms[0] >= FAR_M:
                return moved.where
        return None
