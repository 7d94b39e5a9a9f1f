"""What many episodes tell together: rungs with intervals, errors as vectors, ISO 9283, the breakdown."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from vision_robot.evaluate.pose_accuracy import PoseAccuracy, pose_accuracy
from vision_robot.evaluate.statistics import Interval, wilson_interval
from vision_robot.geometry import SE3
from vision_robot.pick.episode import RUNGS, Episode, Miss, axis_angle
from vision_robot.pick.summary import Spread
from vision_robot.pick.world import World
from vision_robot.types import Array, Float

__all__ = [
    "Group",
    "by_distance",
    "by_thing",
    "by_yaw",
    "closing_offsets_m",
    "distance_from_centre",
    "iso_9283",
    "ladder",
    "placing_offsets_m",
]

DISTANCES = (0.0, 0.25, 0.5, 0.75, np.inf)
"""From the picture's middle, in half diagonals."""

YAWS_DEG = (0.0, 22.5, 67.5, 112.5, 157.5, 180.0)


@dataclass(frozen=True)
class Group:
    """Episodes that have something in common."""

    name: str
    grasps: Interval
    placed: Interval
    position_m: Spread
    yaw_rad: Spread

    @classmethod
    def of(cls, name: str, episodes: Sequence[Episode]) -> "Group":
        """Of the episodes given; those that never closed have no error, but count as failed."""
        misses = [one.closing for one in episodes if one.closing]
        return cls(
            name,
            wilson_interval(sum(one.lifted for one in episodes), len(episodes)),
            wilson_interval(sum(one.placed for one in episodes), len(episodes)),
            Spread.of([miss.position_m for miss in misses]),
            Spread.of([abs(miss.yaw_rad) for miss in misses]),
        )


def ladder(episodes: Sequence[Episode]) -> dict[str, Interval]:
    """Share of episodes that got at least to each rung."""
    return {
        rung: wilson_interval(sum(bool(getattr(one, rung)) for one in episodes), len(episodes))
        for rung in RUNGS
    }


def closing_offsets_m(episodes: Sequence[Episode]) -> Float[Array, "n 2"]:
    """Tool less thing at closing, along {S}'s x and y, of episodes that came so far."""
    return _in_station([(one.closing, one.station_from_object) for one in episodes if one.closing])


def placing_offsets_m(episodes: Sequence[Episode]) -> Float[Array, "n 2"]:
    """Thing less goal when all is at rest, along {S}'s x and y."""
    return _in_station([(one.placing, one.station_from_place) for one in episodes if one.placing])


def _in_station(misses: Sequence[tuple[Miss, SE3]]) -> Float[Array, "n 2"]:
    rows = []
    for miss, pose in misses:
        yaw = axis_angle(pose.rotation, 0)
        c, s = np.cos(yaw), np.sin(yaw)
        rows.append([c * miss.along_m - s * miss.across_m, s * miss.along_m + c * miss.across_m])
    return np.array(rows).reshape(-1, 2)


def iso_9283(misses: Sequence[Miss]) -> PoseAccuracy | None:
    """Accuracy and repeatability in the plane; None of fewer than two.

    A miss is a pose relative to the one that was commanded, so that poses over the table count together.
    Height is left out: what lies on the table has it from the table.
    """
    if len(misses) < 2:
        return None
    turns = np.array([[0.0, 0.0, miss.yaw_rad] for miss in misses])
    places = np.array([[miss.along_m, miss.across_m, 0.0] for miss in misses])
    return pose_accuracy(SE3.identity(), SE3.from_rotvec(turns, places))


def distance_from_centre(world: World, episode: Episode) -> float:
    """Of the thing in the picture, from its middle, in half diagonals; NaN outside the lens."""
    view = world.view_now
    pixel = view.camera.project(
        (view.cam_from_station @ episode.station_from_object).apply(np.zeros((1, 3)))
    )[0]
    size = np.array([view.camera.width, view.camera.height])
    return float(np.linalg.norm(pixel - (size - 1) / 2) / (np.linalg.norm(size) / 2))


def by_distance(world: World, episodes: Sequence[Episode]) -> list[Group]:
    """By distance from the picture's middle."""
    return _binned(
        episodes,
        lambda one: distance_from_centre(world, one),
        DISTANCES,
        lambda low, high: f"{low:g} to {high:g}" if np.isfinite(high) else f"over {low:g}",
    )


def by_yaw(episodes: Sequence[Episode]) -> list[Group]:
    """By direction of the thing's axis in {S}, headless; the first and the last bin are one."""

    def yaw(one: Episode) -> float:
        turned = float(np.degrees(axis_angle(one.station_from_object.rotation, 0))) % 180
        return turned - 180 if turned >= YAWS_DEG[-2] else turned

    edges = (YAWS_DEG[-2] - 180, *YAWS_DEG[1:-1])
    return _binned(episodes, yaw, edges, lambda low, high: f"{low:g}° to {high:g}°".replace("-", "−"))


def by_thing(episodes: Sequence[Episode]) -> list[Group]:
    """By name of what was picked."""
    names = dict.fromkeys(one.thing for one in episodes)
    return [Group.of(name or "–", [one for one in episodes if one.thing == name]) for name in names]


def _binned(
    episodes: Sequence[Episode],
    value: Callable[[Episode], float],
    edges: Sequence[float],
    name: Callable[[float, float], str],
) -> list[Group]:
    values = np.array([value(one) for one in episodes])
    groups = []
    for low, high in pairwise(edges):
        inside = [one for one, here in zip(episodes, values, strict=True) if low <= here < high]
        if inside:
            groups.append(Group.of(name(low, high), inside))
    return groups
