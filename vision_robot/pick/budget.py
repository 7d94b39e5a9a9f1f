"""Where the millimetres come from: the same grasp with each set of stages replaced by the truth."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.arm.ik import InverseKinematics
from vision_robot.errors import NothingSeen, Unreachable
from vision_robot.geometry import SE3
from vision_robot.pick.calibrated import calibrated
from vision_robot.pick.episode import axis_angle, miss_of
from vision_robot.pick.episodes import Plan
from vision_robot.pick.goal import joints_for, station_from_grasp
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.look import Eye, look
from vision_robot.pick.moments import Moments
from vision_robot.pick.open_loop import APPROACH_M
from vision_robot.pick.player import Player
from vision_robot.pick.prediction import predicted
from vision_robot.pick.rehearsal import Rehearsal
from vision_robot.pick.sighting import Seen, Sighting, sighting
from vision_robot.pick.world import World
from vision_robot.sim.cell import Cell
from vision_robot.track.registry import tracker_named
from vision_robot.types import Array, Float

__all__ = ["Counterfactuals", "closing_errors", "counterfactuals"]


@dataclass(frozen=True)
class Counterfactuals:
    """One grasp of one seed, with each of several sets of stages replaced by the truth."""

    seed: int
    misses: Mapping[frozenset[str], Float[Array, "3"]]
    """Set of true stages -> tool against thing at closing: across, along [m], yaw [rad]."""
    predicted: Moments | None
    """What was to be expected of it beforehand."""


@dataclass(frozen=True)
class _Scene:
    """What all counterfactuals of one seed share."""

    world: World
    cell: Cell
    believed: Knowledge
    name: str
    thing: SE3
    seen: Seen
    truly_seen: Seen
    solver: InverseKinematics

    @property
    def height_m(self) -> float:
        """Of the thing's axis over the table."""
        return self.world.design.items[0].size_m[-1] / 2


def counterfactuals(
    world: World, plan: Plan, seed: int, sets: Sequence[frozenset[str]], rehearsal: Rehearsal | None = None
) -> Counterfactuals:
    """The grasp of a seed, open loop, with each of the `sets` of stages true.

    One picture is looked at; camera, plane, arm and thing are the same in all counterfactuals, so
    that they differ in nothing but what was replaced. Without `control` among the true stages the arm is
    moved by its servos, with it the commanded joints are really there. With a `rehearsal` the miss is
    foretold too. Raises NothingSeen and Unreachable.
    """
    scene = _scene(world, plan, seed)
    start = world.told_joints(scene.cell.joints)
    foretold = None
    if rehearsal is not None:
        where = sighting(scene.believed.plane, scene.seen, scene.height_m)
        above = _joints(scene.solver, scene.believed, where, APPROACH_M, start)
        low = _joints(scene.solver, scene.believed, where, 0.0, above)
        foretold = predicted(scene.believed, scene.seen, scene.height_m, low, rehearsal)
    misses = {one: _miss(scene, one, start) for one in sets}
    return Counterfactuals(seed, misses, foretold)


def closing_errors(
    world: World, plan: Plan, seeds: Sequence[int], sets: Sequence[frozenset[str]]
) -> Mapping[frozenset[str], Float[Array, "seeds 3"]]:
    """Misses (across, along [m], yaw [rad]) of several seeds, but those that saw or reached nothing."""
    found = []
    for seed in seeds:
        try:
            found.append(counterfactuals(world, plan, seed, sets).misses)
        except (NothingSeen, Unreachable):
            continue
    return {one: np.array([misses[one] for misses in found]).reshape(-1, 3) for one in sets}


def _scene(world: World, plan: Plan, seed: int) -> _Scene:
    cell = Cell(world.design)
    cell.reset(seed)
    cell.advance(0.3)
    name = world.design.items[0].name
    believed = calibrated(world, seed)
    with Eye(cell, world, seed) as eye:
        tracker = tracker_named(plan.tracker, plan.options)
        seen = look(cell, eye, tracker, name, world, plane=believed.plane)
        truly = eye.truth_of(name)
    return _Scene(
        world, cell, believed, name, cell.station_from(name), seen, truly, InverseKinematics(world.arm)
    )


def _miss(scene: _Scene, true_stages: frozenset[str], start: Float[Array, "n"]) -> Float[Array, "3"]:
    world, cell = scene.world, scene.cell
    knowledge = scene.believed.corrected(world.truth, true_stages)
    seen = scene.truly_seen if "tracking" in true_stages else scene.seen
    where = sighting(knowledge.plane, seen, scene.height_m)
    # The arm as it really is has its encoders' offsets; who knows it commands against them.
    knows_arm = "ik" in true_stages
    above = _joints(scene.solver, knowledge, where, APPROACH_M, start)
    low = _joints(scene.solver, knowledge, where, 0.0, above)
    if knows_arm:
        above, low = world.told_joints(above), world.told_joints(low)
    if "control" in true_stages:
        base_from_tool = world.arm.chain.base_from_tool(world.real_joints(low))
        tool = world.design.base_from_station.inverse() @ base_from_tool
    else:
        cell.pose_arm(world.real_joints(above), opening_m=cell.opening_limits_m[1])
        player = Player(cell, world, scene.solver)
        player.move_to(low)
        tool = cell.station_from_tool
        cell.place(scene.name, scene.thing)
    miss = miss_of(scene.thing, tool.translation, axis_angle(tool.rotation, 1))
    return np.array([miss.across_m, miss.along_m, miss.yaw_rad])


def _joints(
    solver: InverseKinematics, knowledge: Knowledge, where: Sighting, over_m: float, near: Float[Array, "n"]
) -> Float[Array, "n"]:
    goal = station_from_grasp(where.position_m, where.yaw_rad, where.height_m + over_m)
    return joints_for(solver, knowledge.base_from_station, goal, near)
