"""Scenes to pick from: one thing on the table, one among others, one that rides past on a belt."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.pick.world import ROD, World, ordinary_world
from vision_robot.sim.cell_design import Belt, Item

__all__ = ["SCENES", "SceneKind", "scene_named"]

OTHERS = (
    Item("green box", "box", (0.050, 0.025, 0.018), colour=(0.15, 0.55, 0.22)),
    Item("blue rod", "hexagon", (0.090, 0.010), colour=(0.12, 0.28, 0.72)),
    Item("cyan disc", "disc", (0.034, 0.010), colour=(0.10, 0.62, 0.68)),
)
"""What lies in the way where nothing else is asked for."""

CLOSE_M = (-0.05, -0.06, 0.06, 0.08)
"""Region of a crowded table: often things leave each other less room than fingers want."""

WIDE_M = (-0.20, -0.36, 0.24, 0.36)
"""Region that goes past what the camera sees and the arm reaches."""


@dataclass(frozen=True)
class SceneKind:
    """A kind of scene: what it means, and how it comes from its things, the first of which is picked."""

    meaning: str
    make: Callable[[tuple[Item, ...]], World]


def _table(items: tuple[Item, ...]) -> World:
    return ordinary_world(*items)


def _clutter(items: tuple[Item, ...]) -> World:
    world = ordinary_world(*(items if len(items) > 1 else (*items, *OTHERS)))
    return replace(world, design=replace(world.design, scatter_m=CLOSE_M))


def _wide(items: tuple[Item, ...]) -> World:
    world = ordinary_world(*items)
    return replace(world, design=replace(world.design, scatter_m=WIDE_M))


def _conveyor(items: tuple[Item, ...]) -> World:
    if len(items) > 1:
        raise BadParameter("things on the conveyor", len(items), "one at a time")
    belt = Belt(speed_m_s=0.06, width_m=0.16)
    world = ordinary_world(*items)
    design = replace(world.design, belt=belt)
    return replace(world, design=design, place=(belt.width_m / 2 + 0.05, 0.0, np.pi / 2))


SCENES: dict[str, SceneKind] = {
    "table": SceneKind("one thing at any place and yaw", _table),
    "clutter": SceneKind("others lie close to it, and may have to go first", _clutter),
    "wide": SceneKind("it may lie out of sight or out of reach", _wide),
    "conveyor": SceneKind("it rides past on a belt", _conveyor),
}
"""Name -> kind of scene."""


def scene_named(name: str, items: Sequence[Item] = (), *, belt_speed_m_s: float | None = None) -> World:
    """The scene of that name with these things; the first is what is picked.

    Raises BadParameter for an unknown name, listing the known, and for a speed where there is no belt.
    """
    if name not in SCENES:
        raise BadParameter("scene", name, f"one of {', '.join(SCENES)}")
    world = SCENES[name].make(tuple(items) or (ROD,))
    if belt_speed_m_s is None:
        return world
    belt = world.design.belt
    if belt is None:
        raise BadParameter("speed of the belt", belt_speed_m_s, f"left out: scene {name} has no belt")
    if not (np.isfinite(belt_speed_m_s) and belt_speed_m_s > 0):
        raise BadParameter("speed of the belt", belt_speed_m_s, "positive")
    return replace(world, design=replace(world.design, belt=replace(belt, speed_m_s=belt_speed_m_s)))
