"""Picking from a belt: the track tells where a thing will be, and the gripper goes along while closing."""

from dataclasses import dataclass, replace

import numpy as np

from vision_robot.errors import NothingSeen, TooLate, Unreachable, VisionRobotError
from vision_robot.geometry import SE3
from vision_robot.pick.attempt import Attempt
from vision_robot.pick.causes import EXPECTED, cause_of
from vision_robot.pick.episode import Episode, axis_angle, miss_of
from vision_robot.pick.goal import joints_for, station_from_grasp
from vision_robot.pick.grasps import Target, symmetry_of
from vision_robot.pick.look import recognised
from vision_robot.pick.open_loop import APPROACH_M, Hand, holds, placed, stays_up
from vision_robot.pick.sighting import Sighting, sighting
from vision_robot.pick.tolerances import Tolerances
from vision_robot.pick.witness import Witness
from vision_robot.sim.cell_model import resting
from vision_robot.track.blobs import Blobs
from vision_robot.types import Array, Float

__all__ = ["Motion", "fitted", "led", "pick_moving"]

EVERY = 3
"""Of the camera's frames one in so many is looked at: neighbours tell little new of what moves evenly."""

FRAMES, EMPTY, MOST_FRAMES = 10, 6, 120
"""Looks at the thing that its motion is told from; looks at the empty belt before it; looks at most."""

UPSTREAM_M = 0.36
"""How far before the station's middle things are put on the belt: outside the picture."""

CATCH_UP_S, DOWN_S, CLOSE_S, UP_S = 0.35, 0.45, 0.45, 0.6
"""Time to come up to the belt's speed, to come down, to close, and to come to rest on the way up."""

PERIOD_S = 0.02
SPARE_S = 0.2
"""Kept between being there and having to go."""


@dataclass(frozen=True)
class Motion:
    """Where something will be: a straight line at an even speed."""

    time_s: float
    position_m: Float[Array, "2"]
    """At that time."""
    velocity_m_s: Float[Array, "2"]
    sigma_m: float
    """Standard deviation per axis of a single sighting about the line."""
    yaw_rad: float

    def at(self, time_s: float) -> Float[Array, "2"]:
        """Position then."""
        return self.position_m + (time_s - self.time_s) * self.velocity_m_s


def fitted(times_s: Float[Array, "k"], places: Float[Array, "k 2"], yaws_rad: Float[Array, "k"]) -> Motion:
    """The straight, even motion nearest to sightings in least squares; three or more of them."""
    middle = float(times_s.mean())
    design = np.stack([np.ones(len(times_s)), times_s - middle], axis=1)
    solution, *_ = np.linalg.lstsq(design, places)
    off = places - design @ solution
    sigma = float(np.sqrt((off**2).sum() / max(2 * len(times_s) - 4, 1)))
    double = np.exp(2j * yaws_rad[np.isfinite(yaws_rad)])  # headless directions
    yaw = float(np.angle(double.mean()) / 2) if len(double) else 0.0
    return Motion(middle, solution[0], solution[1], sigma, yaw)


def pick_moving(
    attempt: Attempt, episode: Episode, tolerances: Tolerances, seed: int, witness: Witness | None = None
) -> Episode:
    """Let the thing ride by, tell its motion, meet it, and put it down beside the belt."""
    player, begun = attempt.player, attempt.player.cell.time_s
    try:
        motion = _watched(attempt, seed)
        player.hold(player.world.latency_s)
        there = player.cell.station_from(episode.thing)
        where = Sighting(
            motion.at(player.cell.time_s),
            np.eye(2) * motion.sigma_m**2,
            motion.yaw_rad,
            attempt.item_height_m,
        )
        episode = attempt.seen(replace(episode, station_from_object=there), where)
        if witness is not None:
            witness.begins(player.cell, attempt.eye, player, attempt.believed, where, episode)
        target = Target(where, attempt.grasps[0], symmetry_of(attempt.item))
        begun = player.cell.time_s
        episode = _met(attempt, target, motion, episode, tolerances)
        episode = replace(episode, pick_seconds=player.cell.time_s - begun if episode.lifted else np.nan)
        if episode.lifted:
            episode = placed(Hand(player, attempt.believed), target, episode, tolerances)
    except EXPECTED as error:
        episode = replace(episode, failure=str(error), cause=cause_of(error))
        if not episode.seen and witness is not None:
            witness.unseen(player.cell, attempt.eye)
    episode = replace(episode, seconds=player.cell.time_s - begun)
    if witness is not None:
        witness.ends(episode)
    return episode


def _watched(attempt: Attempt, seed: int) -> Motion:
    """Look at the belt until the thing has been seen whole often enough. Raises NothingSeen."""
    player, item, plane = attempt.player, attempt.item, attempt.believed.plane
    cell, world = player.cell, player.world
    belt = world.design.belt
    assert belt is not None
    rng = np.random.default_rng([seed, 3])
    room = max(belt.width_m / 2 - max(item.size_m) / 2, 0.0)
    across, yaw = belt.x_m + rng.uniform(-room, room), rng.uniform(-np.pi, np.pi)
    start = resting(item, np.array([across, -UPSTREAM_M, 0.0, yaw]))
    times, places, yaws = [], [], []
    error: VisionRobotError = NothingSeen(attempt.tracker.name, item.name)
    for frame in range(MOST_FRAMES):
        if frame == EMPTY:
            cell.place(item.name, start, np.array([0.0, belt.speed_m_s, 0, 0, 0, 0]))
        elif frame < EMPTY:
            cell.place(item.name, SE3(np.eye(3), np.array([0.0, 0.0, 5.0])))  # not there yet
        blobs: Blobs = attempt.tracker.step(attempt.eye.picture(), cell.time_s)
        try:
            seen = attempt.eye.truth_of(item.name) if attempt.true_tracking else None
            thing = recognised(blobs, attempt.tracker.name, item, plane).thing
            where = sighting(plane, seen or thing, attempt.item_height_m)
            if frame >= EMPTY and np.isfinite(where.position_m).all():
                times.append(cell.time_s)
                places.append(where.position_m)
                yaws.append(where.yaw_rad)
        except NothingSeen as unseen:
            error = unseen
        if len(times) == FRAMES:
            break
        cell.advance(EVERY / world.frame_rate)
    if len(times) < 3:
        raise error
    return fitted(np.array(times), np.array(places), np.array(yaws))


def _met(
    attempt: Attempt, target: Target, motion: Motion, episode: Episode, tolerances: Tolerances
) -> Episode:
    """Wait over the meeting point, go along, come down, close, and lift."""
    player = attempt.player
    cell, grasp = player.cell, target.grasp
    player.phase = "above"
    start_s, above = _meeting(attempt, target, motion)
    player.grip(grasp.opening_m, seconds=0.1)
    player.move_to(above)
    player.hold(max(start_s - cell.time_s, 0.0))
    begun = cell.time_s
    times, joints = _along(attempt, target, motion, begun)
    down = times <= CATCH_UP_S + DOWN_S + 1e-9
    player.phase = "down"
    player.track(times[down], joints[down])
    tool = cell.station_from_tool
    axis = target.axis_of(cell.station_from(episode.thing))
    closing = miss_of(axis, tool.translation, axis_angle(tool.rotation, 1), target.symmetry_rad)
    player.phase = "close"
    rest = times[~down] - times[down][-1]
    gaps = np.full(len(rest), cell.opening_limits_m[0])
    player.track(rest, joints[~down], gaps)
    gripped = holds(player, episode.thing)
    player.phase = "lift"
    lifted = gripped and stays_up(player, episode.thing, tolerances)
    reached = closing.position_m <= tolerances.reach_m
    return replace(
        episode,
        closing=closing,
        looks=1,
        reached=reached,
        gripped=reached and gripped,
        lifted=reached and lifted,
    )


def _meeting(attempt: Attempt, target: Target, motion: Motion) -> tuple[float, Float[Array, "n"]]:
    """When to set off, and the joint values to wait at; the earliest moment that the arm can keep.

    Raises TooLate where the thing is out of reach before, and Unreachable where it never comes into it.
    """
    player, speed = attempt.player, float(np.linalg.norm(motion.velocity_m_s))
    now, late = player.cell.time_s, False
    ends_after = CATCH_UP_S + DOWN_S + CLOSE_S + UP_S
    short: Unreachable | None = None
    needed = 0.0
    for wait in np.arange(0.3, 12.0, 0.1):
        start = now + float(wait)
        try:
            first = _joints(attempt, target, led(motion, start, 0.0), APPROACH_M, player.joints)
            _joints(attempt, target, led(motion, start, ends_after), APPROACH_M, first)
        except Unreachable as error:
            short = error
            continue
        needed = player.seconds_to(first) + 0.1 + SPARE_S
        if needed <= wait:
            return start, first
        late = True
    if late or short is None:
        raise TooLate(attempt.item.name, speed, needed)
    raise short


def led(motion: Motion, start_s: float, after_s: float) -> Float[Array, "2"]:
    """Where the tool goes: from rest up to the thing's speed, along with it, and to rest again."""
    v, t = motion.velocity_m_s, after_s
    meet = motion.at(start_s + t)
    if t < CATCH_UP_S:
        # Half the way that the thing makes meanwhile is the lead it has to be given.
        return motion.at(start_s) + v * (CATCH_UP_S / 2 + t * t / (2 * CATCH_UP_S))
    off = t - (CATCH_UP_S + DOWN_S + CLOSE_S)
    return meet if off <= 0 else meet - v * off * off / (2 * UP_S)


def _along(
    attempt: Attempt, target: Target, motion: Motion, start_s: float
) -> tuple[Float[Array, "k"], Float[Array, "k n"]]:
    """Times from now and joint values of the whole manoeuvre."""
    whole = CATCH_UP_S + DOWN_S + CLOSE_S + UP_S
    times = np.linspace(0, whole, int(np.ceil(whole / PERIOD_S)) + 1)
    near, rows = attempt.player.joints, []
    for t in times:
        down = np.clip((t - CATCH_UP_S) / DOWN_S, 0, 1)
        up = np.clip((t - CATCH_UP_S - DOWN_S - CLOSE_S) / UP_S, 0, 1)
        height = APPROACH_M * (1 - _eased(float(down)) + _eased(float(up)))
        near = _joints(attempt, target, led(motion, start_s, float(t)), height, near)
        rows.append(near)
    return times, np.array(rows)


def _eased(share: float) -> float:
    """From 0 to 1, at rest at both ends."""
    return share * share * (3 - 2 * share)


def _joints(
    attempt: Attempt, target: Target, place: Float[Array, "2"], height_m: float, near: Float[Array, "n"]
) -> Float[Array, "n"]:
    aim = target.aim_at(replace(target.where, position_m=place))
    goal = station_from_grasp(aim.position_m, aim.yaw_rad, aim.height_m + height_m)
    return joints_for(attempt.player.solver, attempt.believed.base_from_station, goal, near)
