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

TRIES = 40
"""Places tried before a thing waits, or is put down where it is not clear."""
WAIT_S = 0.5
LOOK_AHEAD_S = 1.5
"""So long a place must stay clear after a thing has come there, that it finds a way out in time."""
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
    belt_x_m: float
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
    """Carried by the belt; all that it carries comes past within the time there is."""
    sides = mover.area.places(np.array([[0.0, 0.5], [1.0, 0.5]]))[:, 1]
    speed, half = mover.belt_speed_m_s, mover.footprint.length_m / 2
    # Along {S}'s y, the way the belt runs: from well inside the picture back to what arrives last.
    first, last = sides[0] + 0.6 * (sides[1] - sides[0]), sides[0] - speed * mover.traffic.duration_s
    if speed < 0:
        first, last = sides[0] + 0.4 * (sides[1] - sides[0]), sides[1] - speed * mover.traffic.duration_s
    place, start = np.zeros(4), np.zeros(1, dtype=int)
    for _ in range(TRIES):
        along = first + mover.rng.random() * (last - first)
        yaw = mover.rng.uniform(-np.pi, np.pi)
        sideways = mover.rng.uniform(-0.3, 0.3) * half
        place = np.array([mover.belt_x_m + sideways, along, mover.footprint.above_m, yaw])
        if mover.traffic.free(mover.footprint, place[None], start).all():
            break
    return Straight(_four(place), (0.0, speed, 0.0, 0.0))


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


def _four(place: Float[Array, "4"]) -> tuple[float, float, float, float]:
    x, y, above, yaw = place.tolist()
    return x, y, above, yaw


def _start(mover: Mover) -> tuple[float, float, float, float]:
    """A place that is clear all the time, or where none is found the one that is clear the longest."""
    steps = np.arange(len(mover.traffic.times_s))
    tried = _anywhere(mover)
    clear = mover.traffic.free(mover.footprint, np.repeat(tried[:, None], len(steps), axis=1), steps)
    return _four(tried[int(np.argmax(clear.mean(axis=1)))])


def _anywhere(mover: Mover) -> Float[Array, "tries 4"]:
    """Places to choose from."""
    yaw = mover.rng.uniform(-np.pi, np.pi, TRIES)
    above = np.full(TRIES, mover.footprint.above_m)
    return np.column_stack([mover.area.somewhere(mover.rng, TRIES), above, yaw])


def _wander(mover: Mover, pause_s: float) -> Path:
    """Leg by leg to places whose whole way is clear; waits where there is none."""
    ahead = np.arange(int(LOOK_AHEAD_S / STEP_S) + 1)
    tried = _anywhere(mover)
    clear = mover.traffic.free(mover.footprint, np.repeat(tried[:, None], len(ahead), axis=1), ahead)
    times, places = [0.0], [tried[int(np.argmax(clear.mean(axis=1)))]]
    while times[-1] < mover.traffic.duration_s:
        goal, arrival = _leg(mover, places[-1], times[-1], pause_s)
        times.append(arrival)
        places.append(goal)
        if pause_s > 0:
            times.append(arrival + pause_s)
            places.append(goal.copy())
    return Waypoints(tuple(times), tuple(_four(place) for place in places))


def _leg(
    mover: Mover, place: Float[Array, "4"], now_s: float, pause_s: float
) -> tuple[Float[Array, "4"], float]:
    """The next place and when it is reached: the first of `TRIES` whose way, and a while there, are clear.

    Where none is, the way that is clear the longest; staying is one of the ways.
    """
    goals = np.tile(place, (TRIES, 1))
    goals[:, :2] = mover.area.somewhere(mover.rng, TRIES)
    goals[TRIES // 2 :, :2] = place[:2] + 0.3 * (
        goals[TRIES // 2 :, :2] - place[:2]
    )  # short ways are clear more often
    goals[-1] = place
    legs = np.linalg.norm(goals[:, :2] - place[:2], axis=1) / max(mover.speed_m_s, SLOWEST_M_S)
    legs = np.maximum(legs, STEP_S)
    legs[-1] = WAIT_S
    goals[:-1, 3] += legs[:-1] * mover.spin_rad_s
    first = int(now_s / STEP_S)
    steps = np.arange(first, first + int((legs.max() + pause_s + LOOK_AHEAD_S) / STEP_S) + 2)
    share = np.clip((steps * STEP_S - now_s) / legs[:, None], 0, 1)[..., None]
    clear = mover.traffic.free(mover.footprint, place + share * (goals[:, None] - place), steps)
    # A goal is as good as it is long until something is in the way, up to what is asked.
    blocked = np.where(clear.all(axis=1), len(steps), np.argmin(clear, axis=1)) * STEP_S
    spare = np.minimum(blocked - legs - pause_s - LOOK_AHEAD_S, 0)
    best = int(np.argmax(spare))
    return goals[best], now_s + float(legs[best])
