"""Running episodes: a calibrated cell, a thing at a random place, one attempt; all from a seed."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from vision_robot.arm.ik import InverseKinematics
from vision_robot.errors import BadParameter, NothingSeen
from vision_robot.pick.calibrated import calibrated
from vision_robot.pick.closed_loop import LAWS, ClosedLoop
from vision_robot.pick.episode import Episode, axis_angle
from vision_robot.pick.hand_label import label_of
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.look import Eye, look
from vision_robot.pick.open_loop import pick_and_place, straight
from vision_robot.pick.player import Player
from vision_robot.pick.servo.settings import Servoing
from vision_robot.pick.sighting import sighting
from vision_robot.pick.tolerances import Tolerances
from vision_robot.pick.witness import Witness
from vision_robot.pick.world import World
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_model import resting
from vision_robot.track.registry import tracker_named

__all__ = ["Plan", "run_episode"]

PLACE = (0.02, -0.17, np.pi / 2)
"""Where things are put: x, y [m] and yaw [rad] in {S}."""


OPEN = "open"

LABEL_COLOUR = "pink"


@dataclass(frozen=True)
class Plan:
    """How an episode is run."""

    tracker: str = "rgb"
    options: Mapping[str, Any] = field(default_factory=dict)
    loop: str = "open"
    tolerances: Tolerances = field(default_factory=Tolerances)
    true_stages: frozenset[str] = frozenset()
    """Stages replaced by the truth: what the error budget asks."""
    servoing: Servoing = field(default_factory=Servoing)
    """How a loop is closed."""

    def __post_init__(self) -> None:
        if self.loop not in (OPEN, *LAWS):
            raise BadParameter("loop", self.loop, f"one of {', '.join((OPEN, *LAWS))}")


def run_episode(
    world: World,
    plan: Plan,
    seed: int,
    knowledge: Knowledge | None = None,
    *,
    witness: Witness | None = None,
) -> Episode:
    """One attempt in a cell set up anew; the same for the same world, plan and seed.

    `knowledge` is what the controller believes; without it the cell is calibrated with this seed.
    `witness` watches and changes nothing.
    """
    believed = (knowledge or calibrated(world, seed)).corrected(world.truth, plan.true_stages)
    cell = Cell(world.design)
    cell.reset(seed)
    name = world.design.items[0].name
    goal = resting(world.design.items[0], np.array([PLACE[0], PLACE[1], 0.0, PLACE[2]]))
    cell.advance(0.3)  # until what was scattered lies still
    there = cell.station_from(name)
    episode = Episode(seed, there, goal, name)
    height = world.design.items[0].size_m[-1] / 2
    tracker = tracker_named(plan.tracker, plan.options)
    with Eye(cell, world, seed) as eye:
        try:
            seen = look(cell, eye, tracker, name, world)
        except NothingSeen as error:
            episode = replace(episode, failure=str(error))
            if witness is not None:
                witness.unseen(cell, eye)
                witness.ends(episode)
            return episode
        if "tracking" in plan.true_stages:
            seen = eye.truth_of(name)
        where = sighting(believed.plane, seen, height)
        off = where.position_m - there.translation[:2]
        turn = (where.yaw_rad - axis_angle(there.rotation, 0) + np.pi / 2) % np.pi - np.pi / 2
        episode = replace(episode, seen_error_m=float(np.linalg.norm(off)), seen_yaw_error_rad=float(turn))
        player = Player(cell, world, InverseKinematics(believed.arm))
        if witness is not None:
            witness.begins(cell, eye, player, believed, where, episode)
        if plan.loop == OPEN:
            episode = pick_and_place(cell, player, believed, name, where, episode, plan.tolerances, straight)
        else:
            loop = _closed(plan, eye, believed, world, seed)
            episode = pick_and_place(cell, player, believed, name, where, episode, plan.tolerances, loop)
            episode = replace(episode, course=tuple(loop.looks))
        if witness is not None:
            witness.ends(episode)
        return episode


def _closed(plan: Plan, eye: Eye, believed: Knowledge, world: World, seed: int) -> ClosedLoop:
    """A closed loop by the plan's law; the label's colour is known to the tracker."""
    watcher = tracker_named("rgb", {"color": LABEL_COLOUR})
    true_tracking = "tracking" in plan.true_stages
    mount = world.design.arm
    if mount is None or mount.label is None:
        raise BadParameter("loop", plan.loop, f"{OPEN}: this arm has no label to be seen by")
    return ClosedLoop(
        plan.loop,
        eye,
        watcher,
        believed,
        label_of(believed.arm, mount),
        true_tracking=true_tracking,
        thing=world.design.items[0].name,
        how=plan.servoing,
        seed=seed,
    )
