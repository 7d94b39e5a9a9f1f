"""Open loop (O1): look once, solve, move, close, lift, put down; nothing is looked at again on the way."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.geometry import SE3
from vision_robot.pick.causes import EXPECTED, cause_of
from vision_robot.pick.episode import Episode, axis_angle, miss_of
from vision_robot.pick.goal import joints_for, station_from_grasp
from vision_robot.pick.grasps import Target
from vision_robot.pick.grip import held_by, lifted_m
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.player import Player
from vision_robot.pick.sighting import Sighting
from vision_robot.pick.tolerances import Tolerances
from vision_robot.types import Array, Float

__all__ = ["APPROACH_M", "Approach", "Hand", "holds", "pick_and_place", "placed", "stays_up", "straight"]

APPROACH_M = 0.07
"""Height over the thing from which the tool comes straight down, and to which it goes straight up."""

Approach = Callable[[Player, Sighting, Float[Array, "n"]], tuple[Sighting, int]]
"""(player, what was seen first, joint values above it) -> what is believed in the end, and looks taken."""


def straight(player: Player, first: Sighting, above: Float[Array, "n"]) -> tuple[Sighting, int]:
    """Open loop: go where it was seen."""
    player.phase = "above"
    player.move_to(above)
    return first, 1


@dataclass
class Hand:
    """The arm with what it knows: takes and puts down by what is believed alone."""

    player: Player
    knowledge: Knowledge

    def down_on(self, aim: Sighting) -> None:
        """From over the place straight down to it."""
        high, low = (self._pose(aim, h) for h in (APPROACH_M, 0.0))
        self.player.move_to(self.joints(aim, APPROACH_M))
        self.player.phase = {"carry": "put down"}.get(self.player.phase, "down")
        self.player.move_along(high, low)

    def up_from(self, aim: Sighting) -> None:
        """Straight up again."""
        self.player.move_along(self._pose(aim, 0.0), self._pose(aim, APPROACH_M))

    def close(self) -> None:
        """Close the fingers until something is between them."""
        self.player.phase = "close"
        self.player.grip(self.player.cell.opening_limits_m[0])

    def put_down(self, aim: Sighting, opening_m: float) -> None:
        """Bring what is held over the place, down, let go, and up again."""
        self.player.phase = "carry"
        self.down_on(aim)
        self.player.grip(opening_m)
        self.player.phase = "back"
        self.up_from(aim)

    def joints(self, aim: Sighting, height_m: float) -> Float[Array, "n"]:
        """Joint values that bring the tool `height_m` over the aim."""
        goal = station_from_grasp(aim.position_m, aim.yaw_rad, aim.height_m + height_m)
        return joints_for(self.player.solver, self.knowledge.base_from_station, goal, self.player.joints)

    def aim_for(self, target: Target, where: Sighting) -> Sighting:
        """Where the tool has to be for the target, held as it is now, to lie at another place.

        The arm may bring it there turned by half a turn: what is held off its middle then lies on the other
        side of the tool.
        """
        turned = self.is_turned(target.aim, self.player.joints)
        aims = [target.aim_at(replace(where, yaw_rad=where.yaw_rad + half)) for half in (0.0, np.pi)]
        same = [self.is_turned(aim, self.joints(aim, APPROACH_M)) == turned for aim in aims]
        return aims[same.index(True)] if any(same) else aims[0]

    def is_turned(self, aim: Sighting, joints: Float[Array, "n"]) -> bool:
        """Of the two ways round in which fingers take an axis, whether it is the other one."""
        base_from_tool = self.knowledge.arm.chain.base_from_tool(joints)
        tool = self.knowledge.base_from_station.inverse() @ base_from_tool
        along = np.array([np.cos(aim.yaw_rad), np.sin(aim.yaw_rad)])
        return bool(tool.rotation[:2, 1] @ along < 0)

    def _pose(self, aim: Sighting, height_m: float) -> SE3:
        """The tool pose in {B} that `joints` meets."""
        return self.knowledge.arm.chain.base_from_tool(self.joints(aim, height_m))


def pick_and_place(
    player: Player,
    knowledge: Knowledge,
    target: Target,
    episode: Episode,
    tolerances: Tolerances,
    approach: Approach = straight,
) -> Episode:
    """Play the whole episode for the episode's thing, from where the `target` was seen.

    The episode comes back with all that is true about it; nothing true is used on the way.
    """
    hand, begun = Hand(player, knowledge), player.cell.time_s
    try:
        episode = _pick(hand, target, episode, tolerances, approach)
        episode = replace(episode, pick_seconds=player.cell.time_s - begun if episode.lifted else np.nan)
        if episode.lifted:
            episode = placed(hand, target, episode, tolerances)
    except EXPECTED as error:
        episode = replace(episode, failure=str(error), cause=cause_of(error))
    return replace(episode, seconds=player.cell.time_s - begun)


def _pick(
    hand: Hand, target: Target, episode: Episode, tolerances: Tolerances, approach: Approach
) -> Episode:
    player = hand.player
    cell = player.cell
    player.phase = "open"
    player.grip(target.grasp.opening_m, seconds=0.2)
    aim, looks = approach(player, target.aim, hand.joints(target.aim, APPROACH_M))
    player.phase = "above"
    hand.down_on(aim)
    tool = cell.station_from_tool
    axis = target.axis_of(cell.station_from(episode.thing))
    closing = miss_of(axis, tool.translation, axis_angle(tool.rotation, 1), target.symmetry_rad)
    hand.close()
    gripped = holds(player, episode.thing)
    player.phase = "lift"
    hand.up_from(aim)
    lifted = gripped and stays_up(player, episode.thing, tolerances)
    reached = closing.position_m <= tolerances.reach_m
    return replace(
        episode,
        closing=closing,
        looks=looks,
        reached=reached,
        gripped=reached and gripped,
        lifted=reached and lifted,
    )


def holds(player: Player, thing: str) -> bool:
    """Whether parts of the gripper really press on the thing from both sides."""
    return len(held_by(player.cell, thing)) >= 2


def stays_up(player: Player, thing: str, tolerances: Tolerances) -> bool:
    """Whether it is as high as it has to be for as long as it has to be."""
    heights = []
    for _ in range(10):
        player.hold(tolerances.hold_s / 10)
        heights.append(lifted_m(player.cell, thing))
    return min(heights) >= tolerances.lift_m


def placed(hand: Hand, target: Target, episode: Episode, tolerances: Tolerances) -> Episode:
    """Put down what is held where the episode wants it, and see how well that went."""
    goal = episode.station_from_place
    yaw = axis_angle(goal.rotation, 0)
    where = Sighting(goal.translation[:2], np.zeros((2, 2)), yaw, float(goal.translation[2]))
    hand.put_down(hand.aim_for(target, where), target.grasp.opening_m)
    hand.player.hold(0.5)
    thing = hand.player.cell.station_from(episode.thing)
    placing = miss_of(goal, thing.translation, axis_angle(thing.rotation, 0), target.symmetry_rad)
    turned = np.nan_to_num(abs(placing.yaw_rad)) > tolerances.place_yaw_rad
    return replace(episode, placing=placing, placed=placing.position_m <= tolerances.place_m and not turned)
