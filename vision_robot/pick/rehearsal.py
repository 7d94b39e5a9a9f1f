"""How well tracker and servos do their part, found beforehand: things at known places, encoders read back."""

from dataclasses import dataclass, replace

import numpy as np

from vision_robot.arm.ik import InverseKinematics
from vision_robot.errors import NothingSeen, Unreachable
from vision_robot.pick.episode import axis_angle
from vision_robot.pick.episodes import Plan
from vision_robot.pick.goal import joints_for, station_from_grasp
from vision_robot.pick.look import Eye, look
from vision_robot.pick.player import Player
from vision_robot.pick.sighting import as_middle
from vision_robot.pick.world import World
from vision_robot.sim.cell import Cell
from vision_robot.track.registry import tracker_named
from vision_robot.types import Array, Float

__all__ = ["Rehearsal", "rehearsed"]

OTHER_SEEDS = 1_000_000
"""Added to a seed: rehearsal and performance share no scene."""

OVER_M = 0.07
"""Height from which the arm comes down when its servos are tried."""


@dataclass(frozen=True)
class Rehearsal:
    """Mean products of errors about zero, so that a bias counts as an error too."""

    seen_covariance: Float[Array, "3 3"]
    """Of what a tracker says: u [px], v [px] of the centroid, yaw in the picture [rad]."""
    servo_covariance: Float[Array, "n n"]
    """Of joints where they were sent [m, rad], by their encoders."""
    looks: int
    """How many places the first is from."""


def rehearsed(world: World, plan: Plan, *, places: int = 24, seed: int = 0) -> Rehearsal:
    """Try tracker and servos at `places` that are known: as one would with a jig and the encoders.

    Only where in the picture the thing's middle is counts here, so that it does not matter whether the camera
    was knocked. Raises NothingSeen where the tracker never says
    anything, and Unreachable where the arm reaches no place.
    """
    cell = Cell(world.design)
    name = world.design.items[0].name
    off_seen, off_joints = [], []
    solver = InverseKinematics(world.arm)
    # Play in the joints lies behind the encoders: they do not see it.
    without_play = replace(world, backlash=None)
    missed: NothingSeen | Unreachable | None = None
    with Eye(cell, world, seed + OTHER_SEEDS) as eye:
        for k in range(places):
            cell.reset(seed + OTHER_SEEDS + k)
            cell.advance(0.3)
            try:
                said = look(cell, eye, tracker_named(plan.tracker, plan.options), name, world)
                truly = eye.truth_of(name)
                said = as_middle(world.truth.plane, said, world.design.items[0].size_m[-1] / 2)
                turn = (said.yaw_rad - truly.yaw_rad + np.pi / 2) % np.pi - np.pi / 2
                off_seen.append([*(said.centroid_px - truly.centroid_px), turn])
                off_joints.append(_servo_error(cell, without_play, solver, name))
            except (NothingSeen, Unreachable) as error:
                missed = error
    if not off_seen or not off_joints:
        assert missed is not None, "each place gave either figures or an error"
        raise missed
    seen, joints = np.array(off_seen), np.array(off_joints)
    return Rehearsal(seen.T @ seen / len(seen), joints.T @ joints / len(joints), len(seen))


def _servo_error(cell: Cell, world: World, solver: InverseKinematics, name: str) -> Float[Array, "n"]:
    """Joints by their encoders less what they were sent to, after coming down on the thing."""
    there = cell.station_from(name)
    yaw, height = axis_angle(there.rotation, 0), float(there.translation[2])
    station, near = world.design.base_from_station, world.told_joints(cell.joints)
    above = joints_for(solver, station, station_from_grasp(there.translation[:2], yaw, height + OVER_M), near)
    low = joints_for(solver, station, station_from_grasp(there.translation[:2], yaw, height), above)
    cell.pose_arm(world.real_joints(above), opening_m=cell.opening_limits_m[1])
    Player(cell, world, solver).move_to(low)
    return world.told_joints(cell.joints) - low
