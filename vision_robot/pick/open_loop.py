"""Open loop (O1): look once, solve, move, close, lift, put down; nothing is looked at again on the way."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from vision_robot.errors import BadPath, LostSight, NothingSeen, ServoAstray, Unreachable
from vision_robot.geometry import SE3
from vision_robot.pick.episode import Episode, axis_angle, miss_of
from vision_robot.pick.goal import joints_for, station_from_grasp
from vision_robot.pick.grip import held_by, lifted_m
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.player import Player
from vision_robot.pick.sighting import Sighting
from vision_robot.pick.tolerances import Tolerances
from vision_robot.sim.cell import Cell
from vision_robot.types import Array, Float

__all__ = ["APPROACH_M", "Approach", "pick_and_place"]

APPROACH_M = 0.07
"""Height over the thing from which the tool comes straight down, and to which it goes straight up."""

OPENING_M = 0.036
"""Gap of the fingers before they close."""

BOTH = frozenset({"left_finger", "right_finger"})

Approach = Callable[[Player, Sighting, Float[Array, "n"]], tuple[Sighting, int]]
"""(player, what was seen first, joint values above it) -> what is believed in the end, and looks taken."""


def straight(player: Player, first: Sighting, above: Float[Array, "n"]) -> tuple[Sighting, int]:
    """Open loop: go where it was seen."""
    player.phase = "above"
    player.move_to(above)
    return first, 1


def pick_and_place(
    cell: Cell,
    player: Player,
    knowledge: Knowledge,
    name: str,
    seen: Sighting,
    episode: Episode,
    tolerances: Tolerances,
    approach: Approach = straight,
) -> Episode:
    """Play the whole episode for the thing called `name`, from where it was `seen`.

    The episode comes back with all that is true about it; nothing true is used on the way.
    """
    begun = cell.time_s
    try:
        episode = _pick(cell, player, knowledge, name, seen, episode, tolerances, approach)
        if episode.lifted:
            episode = _place(cell, player, knowledge, name, episode, tolerances)
    except (Unreachable, BadPath, NothingSeen, LostSight, ServoAstray) as error:
        episode = replace(episode, failure=str(error))
    return replace(episode, seconds=cell.time_s - begun)


def _pick(
    cell: Cell,
    player: Player,
    knowledge: Knowledge,
    name: str,
    seen: Sighting,
    episode: Episode,
    tolerances: Tolerances,
    approach: Approach,
) -> Episode:
    player.phase = "open"
    player.grip(OPENING_M, seconds=0.2)
    above = _joints(player, knowledge, seen, APPROACH_M)
    seen, looks = approach(player, seen, above)
    high, low = (_pose(player, knowledge, seen, h) for h in (APPROACH_M, 0.0))
    player.phase = "above"
    player.move_to(_joints(player, knowledge, seen, APPROACH_M))
    player.phase = "down"
    player.move_along(high, low)
    tool = cell.station_from_tool
    closing = miss_of(cell.station_from(name), tool.translation, axis_angle(tool.rotation, 1))
    player.phase = "close"
    player.grip(cell.opening_limits_m[0])
    gripped = held_by(cell, name) >= BOTH
    player.phase = "lift"
    player.move_along(low, high)
    lifted = False
    if gripped:
        heights = []
        for _ in range(10):
            player.hold(tolerances.hold_s / 10)
            heights.append(lifted_m(cell, name))
        lifted = min(heights) >= tolerances.lift_m
    reached = closing.position_m <= tolerances.reach_m
    return replace(
        episode,
        closing=closing,
        looks=looks,
        reached=reached,
        gripped=reached and gripped,
        lifted=reached and lifted,
    )


def _place(
    cell: Cell, player: Player, knowledge: Knowledge, name: str, episode: Episode, tolerances: Tolerances
) -> Episode:
    goal = episode.station_from_place
    yaw = axis_angle(goal.rotation, 0)
    where = Sighting(goal.translation[:2], np.zeros((2, 2)), yaw, float(goal.translation[2]))
    high, low = (_pose(player, knowledge, where, h) for h in (APPROACH_M, 0.0))
    player.phase = "carry"
    player.move_to(_joints(player, knowledge, where, APPROACH_M))
    player.phase = "put down"
    player.move_along(high, low)
    player.grip(OPENING_M)
    player.phase = "back"
    player.move_along(low, high)
    player.hold(0.5)
    thing = cell.station_from(name)
    placing = miss_of(goal, thing.translation, axis_angle(thing.rotation, 0))
    placed = placing.position_m <= tolerances.place_m and abs(placing.yaw_rad) <= tolerances.place_yaw_rad
    return replace(episode, placing=placing, placed=placed)


def _joints(player: Player, knowledge: Knowledge, seen: Sighting, height_m: float) -> Float[Array, "n"]:
    """Joint values that bring the tool `height_m` over the thing's axis."""
    goal = station_from_grasp(seen.position_m, seen.yaw_rad, seen.height_m + height_m)
    return joints_for(player.solver, knowledge.base_from_station, goal, player.joints)


def _pose(player: Player, knowledge: Knowledge, seen: Sighting, height_m: float) -> SE3:
    """The tool pose in {B} that `_joints` meets."""
    return knowledge.arm.chain.base_from_tool(_joints(player, knowledge, seen, height_m))
