"""Running episodes: a calibrated cell, a thing at a random place, one or more tries; all from a seed."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from vision_robot.arm.ik import InverseKinematics
from vision_robot.errors import BadArm, BadParameter
from vision_robot.pick.attempt import Attempt
from vision_robot.pick.calibrated import calibrated
from vision_robot.pick.causes import EXPECTED, cause_of
from vision_robot.pick.closed_loop import LAWS, ClosedLoop
from vision_robot.pick.conveyor import pick_moving
from vision_robot.pick.episode import Episode
from vision_robot.pick.hand_label import label_of
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.look import Eye
from vision_robot.pick.open_loop import pick_and_place, straight
from vision_robot.pick.player import Player
from vision_robot.pick.servo.settings import Servoing
from vision_robot.pick.tolerances import Tolerances
from vision_robot.pick.witness import Witness
from vision_robot.pick.world import World
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_model import resting
from vision_robot.track.registry import tracker_named

__all__ = ["Plan", "run_episode"]

OPEN = "open"

LABEL_COLOUR = "pink"

SETTLE_S = 0.3
"""Until what was scattered lies still."""


@dataclass(frozen=True)
class Plan:
    """How an episode is run."""

    tracker: str = "rgb"
    options: Mapping[str, Any] = field(default_factory=dict)
    loop: str = "open"
    tolerances: Tolerances = field(default_factory=Tolerances)
    true_stages: frozenset[str] = frozenset()
    """Stages replaced by the truth: what the error budget asks."""
    tries: int = 1
    """How often the thing is gone for, when fingers close on nothing."""
    servoing: Servoing = field(default_factory=Servoing)
    """How a loop is closed."""

    def __post_init__(self) -> None:
        if self.loop not in (OPEN, *LAWS):
            raise BadParameter("loop", self.loop, f"one of {', '.join((OPEN, *LAWS))}")
        if self.tries < 1:
            raise BadParameter("tries", self.tries, "a whole number from 1 on")


def run_episode(
    world: World,
    plan: Plan,
    seed: int,
    knowledge: Knowledge | None = None,
    *,
    witness: Witness | None = None,
) -> Episode:
    """One thing gone for in a cell set up anew; the same for the same world, plan and seed.

    `knowledge` is what the controller believes; without it the cell is calibrated with this seed.
    `witness` watches and changes nothing.
    """
    believed = (knowledge or calibrated(world, seed)).corrected(world.truth, plan.true_stages)
    cell = Cell(world.design)
    if cell.fingers is None:
        raise BadArm(world.arm.name, "it has no fingers beyond the tool that move by themselves: no gripper")
    cell.reset(seed)
    item = world.design.items[0]
    x, y, yaw = world.place
    goal = resting(item, np.array([x, y, 0.0, yaw]))
    cell.advance(SETTLE_S)
    with Eye(cell, world, seed) as eye:
        tracker = tracker_named(plan.tracker, plan.options)
        player = Player(cell, world, InverseKinematics(believed.arm))
        attempt = Attempt(eye, player, believed, tracker, "tracking" in plan.true_stages)
        episode = Episode(seed, cell.station_from(item.name), goal, item.name)
        if world.design.belt is not None:
            if plan.loop != OPEN:
                raise BadParameter("loop", plan.loop, f"{OPEN}: on a belt things do not wait to be looked at")
            return pick_moving(attempt, episode, plan.tolerances, seed, witness)
        return _tried(attempt, episode, plan, witness)


def _tried(attempt: Attempt, episode: Episode, plan: Plan, witness: Witness | None) -> Episode:
    """Look and go for it, again after fingers closed on nothing."""
    player, begun = attempt.player, attempt.player.cell.time_s
    for number in range(1, plan.tries + 1):
        try:
            where = attempt.found(again=number > 1)
            if number == 1:
                episode = attempt.seen(episode, where)
                if witness is not None:
                    witness.begins(player.cell, attempt.eye, player, attempt.believed, where, episode)
            target, cleared = attempt.free(where)
            episode = replace(episode, cleared=episode.cleared + cleared, tries=number)
        except EXPECTED as error:
            episode = replace(episode, failure=str(error), cause=cause_of(error))
            if number == 1 and not episode.seen and witness is not None:
                witness.unseen(player.cell, attempt.eye)
            break
        loop = None if plan.loop == OPEN else _closed(plan, attempt, episode.seed)
        episode = pick_and_place(player, attempt.believed, target, episode, plan.tolerances, loop or straight)
        if loop is not None:
            episode = replace(episode, course=tuple(loop.looks))
        if episode.gripped or episode.cause:
            break
    if np.isfinite(episode.seconds):
        seconds = player.cell.time_s - begun
        before = seconds - episode.seconds
        episode = replace(episode, seconds=seconds, pick_seconds=episode.pick_seconds + before)
    if witness is not None:
        witness.ends(episode)
    return episode


def _closed(plan: Plan, attempt: Attempt, seed: int) -> ClosedLoop:
    """A closed loop by the plan's law; the label's colour is known to the tracker."""
    world, believed = attempt.player.world, attempt.believed
    watcher = tracker_named("rgb", {"color": LABEL_COLOUR})
    mount = world.design.arm
    if mount is None or mount.label is None:
        raise BadParameter("loop", plan.loop, f"{OPEN}: this arm has no label to be seen by")
    return ClosedLoop(
        plan.loop,
        attempt.eye,
        watcher,
        believed,
        label_of(believed.arm, mount),
        true_tracking=attempt.true_tracking,
        thing=attempt.item.name,
        how=plan.servoing,
        seed=seed,
    )
