"""How things move: one function a motion, each gives a path known exactly at every time."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from vision_robot.sim.paths import Circle, Path, Straight, Sway, Waypoints
from vision_robot.types import Array, Float
from vision_robot_synth.scene.area import Area
from vision_robot_synth.scene.traffic import STEP_S, Footprint, Traffic

__all__ = ["MOTIONS", "Motion", "Mover"]

TRIES = 60
"""Places tried before a thing waits, or is put down where it is not clear."""
WAIT_S = 0.5
SLOWEST_M_S = 1e-4


@dataclass(frozen=True)
class Mover:
    """All that a motion may depend on."""

    footprint: Footprint
    speed_m_s: float
    spin_rad_s: float
    pause_s: float
    area: Area
    traffic: Traffic
    rank: int
    """Which of how many of its kind it is."""
    count: int
    belt_speed_m_s: float
    belt_y_m: float
    rng: np.random.Generator


class Motion(NamedTuple):
    """A way to move."""

    text: str
    path: Callable[[Mover], Path]
    lies: bool = False
    """Whether it lies still on the table."""
    free: bool = False
    """Whether physics alone moves it."""


def rest(mover: Mover) -> Path:
    """Lies still."""
    return Straight(_start(mover))


def roam(mover: Mover) -> Path:
    """From place to place in straight lines."""
    return _wander(mover, 0.0)


def stop(mover: Mover) -> Path:
    """From place to place, and stands still at each for a while."""
    return _wander(mover, mover.pause_s)


def across(mover: Mover) -> Path:
    """To and fro through the middle; those of one kind come from all sides and meet there."""
    share = (mover.rank + 0.5 * mover.rng.random()) / (2 * max(mover.count, 1))
    ends = mover.area.edge(share), mover.area.edge(share + 0.5)
    leg = max(float(np.linalg.norm(ends[1] - ends[0])) / max(mover.speed_m_s, SLOWEST_M_S), STEP_S)
    yaw, places, times = mover.rng.uniform(-np.pi, np.pi), [], []
    for i in range(int(mover.traffic.duration_s / leg) + 2):
        times.append(i * leg)
        places.append((*ends[i % 2], mover.footprint.above_m, yaw + i * leg * mover.spin_rad_s))
    return Waypoints(tuple(times), tuple(places))


def sway(mover: Mover) -> Path:
    """To and fro about a place, as a sine."""
    middle = np.array(_start(mover))
    direction = mover.rng.uniform(0, 2 * np.pi)
    reach = 0.35 * mover.area.reach_m
    period = 2 * np.pi * reach / max(mover.speed_m_s, SLOWEST_M_S)
    turn = mover.spin_rad_s * period / (2 * np.pi)
    along = (reach * np.cos(direction), reach * np.sin(direction), 0.0, turn)
    return Sway(tuple(middle), along, period)


def circle(mover: Mover) -> Path:
    """Round the middle of the picture."""
    centre = mover.area.places(np.array([[0.5, 0.5]]))[0]
    # Those of one kind share the ring evenly.
    radius = mover.area.reach_m * (0.55 + 0.3 * (mover.rank % 2))
    phase = 2 * np.pi * (mover.rank + 0.2 * mover.rng.random()) / max(mover.count, 1)
    yaw = mover.rng.uniform(-np.pi, np.pi)
    x, y = float(centre[0]), float(centre[1])
    return Circle((x, y), radius, mover.speed_m_s / radius, phase, yaw, mover.spin_rad_s)


def belt(mover: Mover) -> Path:
    """Carried by the belt, one after the other."""
    left = mover.area.places(np.array([[0.0, 0.5], [1.0, 0.5]]))
    # Along {S}'s y, the way the belt runs; the first is in the picture from the start.
    width = float(np.abs(left[1, 1] - left[0, 1]))
    speed = mover.belt_speed_m_s
    gap = max(0.35 * width, 1.3 * mover.footprint.length_m)
    along = -width / 2 + 0.3 * width - np.sign(speed or 1) * gap * mover.rank
    sideways = mover.rng.uniform(-0.25, 0.25) * mover.footprint.length_m
    yaw = mover.rng.uniform(-np.pi, np.pi)
    start = (mover.belt_y_m + sideways, along, mover.footprint.above_m, yaw)
    return Straight(start, (0.0, speed, 0.0, 0.0))


MOTIONS: dict[str, Motion] = {
    "rest": Motion("lie still", rest, lies=True),
    "free": Motion("are left to physics", rest, free=True),
    "roam": Motion("go from place to place", roam),
    "stop": Motion("roam, and pause at each place", stop),
    "across": Motion("go to and fro through the middle and meet there", across),
    "sway": Motion("swing about a place", sway),
    "circle": Motion("go round the middle", circle),
    "belt": Motion("are carried by the belt", belt),
}


def _start(mover: Mover) -> tuple[float, float, float, float]:
    """A clear place for the whole time, or where none is found the last one tried."""
    steps = np.arange(len(mover.traffic.times_s))
    place = np.zeros(4)
    for _ in range(TRIES):
        place = np.array([*mover.area.somewhere(mover.rng), mover.footprint.above_m, mover.rng.uniform(-np.pi, np.pi)])
        if mover.traffic.free(mover.footprint, np.tile(place, (len(steps), 1)), steps).all():
            break
    return float(place[0]), float(place[1]), float(place[2]), float(place[3])


def _wander(mover: Mover, pause_s: float) -> Path:
    """Legs to places, each the first of `TRIES` whose whole way is clear; waits where none is."""
    steps = np.arange(1)
    place = np.zeros(4)
    for _ in range(TRIES):
        place = np.array([*mover.area.somewhere(mover.rng), mover.footprint.above_m, mover.rng.uniform(-np.pi, np.pi)])
        if mover.traffic.free(mover.footprint, place[None], steps).all():
            break
    times, places = [0.0], [place]
    while times[-1] < mover.traffic.duration_s:
        for goal, arrival in _legs(mover, places[-1], times[-1], pause_s):
            times.append(arrival)
            places.append(goal)
    return Waypoints(tuple(times), tuple(tuple(map(float, one)) for one in places))  # type: ignore[misc]


def _legs(
    mover: Mover, place: Float[Array, "4"], now_s: float, pause_s: float
) -> list[tuple[Float[Array, "4"], float]]:
    """The next leg, with its pause: places and when they are reached."""
    candidates = []
    for attempt in range(TRIES):
        goal = np.array([*mover.area.somewhere(mover.rng), place[2], place[3]])
        if attempt > TRIES // 2:  # a short way is more often clear
            goal[:2] = place[:2] + (goal[:2] - place[:2]) * 0.3
        leg = max(float(np.linalg.norm(goal[:2] - place[:2])) / max(mover.speed_m_s, SLOWEST_M_S), STEP_S)
        goal[3] += leg * mover.spin_rad_s
        length = leg + pause_s
        steps = np.arange(int(now_s / STEP_S), int((now_s + length) / STEP_S) + 2)
        share = np.clip((steps * STEP_S - now_s) / leg, 0, 1)[:, None]
        way = place + share * (goal - place)
        clear = mover.traffic.free(mover.footprint, way, steps)
        if clear.all():
            return _with_pause(goal, now_s + leg, pause_s)
        candidates.append((int(clear.sum()) / len(clear), leg, goal))
    stay = np.arange(int(now_s / STEP_S), int((now_s + WAIT_S) / STEP_S) + 2)
    if mover.traffic.free(mover.footprint, np.tile(place, (len(stay), 1)), stay).all():
        return [(place.copy(), now_s + WAIT_S)]
    _, leg, goal = max(candidates, key=lambda one: one[0])
    return _with_pause(goal, now_s + leg, pause_s)


def _with_pause(
    goal: Float[Array, "4"], arrival_s: float, pause_s: float
) -> list[tuple[Float[Array, "4"], float]]:
    ways = [(goal, arrival_s)]
    return [*ways, (goal.copy(), arrival_s + pause_s)] if pause_s > 0 else ways
