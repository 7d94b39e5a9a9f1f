"""Where the millimetres come from: the same grasp with each set of stages replaced by the truth."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.arm.ik import InverseKinematics
from vision_robot.pick.calibrated import calibrated
from vision_robot.pick.episode import axis_angle, miss_of
from vision_robot.pick.episodes import Plan
from vision_robot.pick.goal import joints_for, station_from_grasp
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.look import Eye, look
from vision_robot.pick.open_loop import APPROACH_M
from vision_robot.pick.player import Player
from vision_robot.pick.sighting import Seen, Sighting, sighting
from vision_robot.pick.world import World
from vision_robot.sim.cell import Cell
from vision_robot.track.registry import tracker_named
from vision_robot.types import Array, Float

__all__ = ["closing_errors"]


@dataclass(frozen=True)
class _Scene:
    """What all counterfactuals of one seed share."""

    world: World
    cell: Cell
    believed: Knowledge
    name: str
    seen: Seen
    truly_seen: Seen
    solver: InverseKinematics


def closing_errors(
    world: World, plan: Plan, seeds: Sequence[int], sets: Sequence[frozenset[str]]
) -> Mapping[frozenset[str], Float[Array, "seeds"]]:
    """Position error of the tool at closing [m], open loop, with each of the `sets` of stages true.

    One picture a seed is looked at; camera, plane, arm and thing are the same in all counterfactuals, so
    that they differ in nothing but what was replaced. Without `control` among the true stages the arm is
    moved by its servos, with it the commanded joints are really there.
    """
    found: dict[frozenset[str], list[float]] = {one: [] for one in sets}
    for seed in seeds:
        scene = _scene(world, plan, seed)
        for one in sets:
            found[one].append(_closing_error(scene, one))
    return {one: np.array(values) for one, values in found.items()}


def _scene(world: World, plan: Plan, seed: int) -> _Scene:
    cell = Cell(world.design)
    cell.reset(seed)
    cell.advance(0.3)
    name = world.design.items[0].name
    with Eye(cell, world, seed) as eye:
        seen = look(cell, eye, tracker_named(plan.tracker, plan.options), name, world)
        truly = eye.truth_of(name)
    return _Scene(world, cell, calibrated(world, seed), name, seen, truly, InverseKinematics(world.arm))


def _closing_error(scene: _Scene, true_stages: frozenset[str]) -> float:
    world, cell = scene.world, scene.cell
    knowledge = scene.believed.corrected(world.truth, true_stages)
    seen = scene.truly_seen if "tracking" in true_stages else scene.seen
    where = sighting(knowledge.plane, seen, world.design.items[0].size_m[-1] / 2)
    # The arm as it really is has its encoders' offsets; who knows it commands against them.
    knows_arm = "ik" in true_stages
    solver, start = scene.solver, world.told_joints(cell.joints)
    above = _joints(solver, knowledge, where, APPROACH_M, start)
    low = _joints(solver, knowledge, where, 0.0, above)
    if knows_arm:
        above, low = world.told_joints(above), world.told_joints(low)
    thing = cell.station_from(scene.name)
    if "control" in true_stages:
        base_from_tool = world.arm.chain.base_from_tool(world.real_joints(low))
        tool = world.design.base_from_station.inverse() @ base_from_tool
    else:
        cell.pose_arm(world.real_joints(above), opening_m=cell.opening_limits_m[1])
        player = Player(cell, world, solver)
        player.move_to(low)
        tool = cell.station_from_tool
        cell.place(scene.name, thing)
    return miss_of(thing, tool.translation, axis_angle(tool.rotation, 1)).position_m


def _joints(
    solver: InverseKinematics, knowledge: Knowledge, where: Sighting, over_m: float, near: Float[Array, "n"]
) -> Float[Array, "n"]:
    goal = station_from_grasp(where.position_m, where.yaw_rad, where.height_m + over_m)
    return joints_for(solver, knowledge.base_from_station, goal, near)
