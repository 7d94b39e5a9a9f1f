"""The cell that `vr pick` is asked for: scene, things, arm and faults, from their words."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from vision_robot.errors import BadParameter
from vision_robot.pick.faults import FAULTS, with_fault, with_lens
from vision_robot.pick.scenes import scene_named
from vision_robot.pick.world import World
from vision_robot.sim.cell_design import Item
from vision_robot.sim.shapes import SHAPES
from vision_robot_cli.quantities import METRES, quantity

__all__ = ["CellWish", "item_of", "world_of"]

USUAL_MM = {
    "rod": (120, 10),
    "hexagon": (110, 9),
    "pencil": (140, 8),
    "box": (50, 30, 20),
    "disc": (40, 10),
}
"""Sizes of things whose size is not given."""

USUAL_COLOURS = ("red", "green", "blue", "cyan", "yellow", "violet")
"""Of the first thing, the second, ..."""


@dataclass(frozen=True)
class CellWish:
    """What was typed."""

    scene: str = "table"
    objects: Sequence[str] = ()
    recipe: str | None = None
    belt_speed: str | None = None
    faults: Sequence[str] = ()
    arm: str = "column"
    tool: str | None = None
    base: str | None = None


def world_of(wish: CellWish, seed: int) -> World:
    """The cell, faults included. Raises BadParameter, BadRecipe and BadArm."""
    speed = None if wish.belt_speed is None else _speed(wish.belt_speed)
    if wish.recipe is not None:
        if wish.objects or wish.scene != "table":
            raise BadParameter("--recipe", wish.recipe, "left out with --object and --scene")
        world = _of_recipe(wish.recipe, seed, speed)
    else:
        items = [item_of(text, k) for k, text in enumerate(wish.objects)]
        world = scene_named(wish.scene, items, belt_speed_m_s=speed)
    if wish.arm != "column" or wish.tool or wish.base:
        from vision_robot.pick.mounting import with_arm

        world = with_arm(world, wish.arm, tool=wish.tool, base=wish.base)
    for one in wish.faults:
        world = _faulty(world, one)
    return world


def item_of(text: str, index: int) -> Item:
    """``box:50x30x20mm:red``: shape, size and colour, of which the last two may be left out."""
    from vision_robot_synth.recipe.colours import COLOURS

    shape, *rest = (word.strip() for word in text.split(":"))
    if shape not in SHAPES:
        raise BadParameter("--object", text, f"a shape ({', '.join(SHAPES)}), then :size:colour if wanted")
    size, colour = tuple(value / 1e3 for value in USUAL_MM[shape]), USUAL_COLOURS[index % len(USUAL_COLOURS)]
    for word in rest:
        if word in COLOURS:
            colour = word
        else:
            size = _size(word, shape, text)
    return Item(shape if index == 0 else f"{shape} {index + 1}", shape, size, COLOURS[colour])


def colour_names(items: Sequence[Item]) -> tuple[str, ...]:
    """What a tracker calls the colours of things, the first one's first, each once."""
    import numpy as np

    from vision_robot.track.colour_names import COLOURS

    found: list[str] = []
    for item in items:
        bgr = np.round(255 * np.array(item.colour[::-1])).astype(np.uint8)
        name = next((name for name, colour in COLOURS.items() if colour.holds(bgr)), None)
        if name is not None and name not in found:
            found.append(name)
    return tuple(found)


def _size(word: str, shape: str, text: str) -> tuple[float, ...]:
    match = re.fullmatch(r"([0-9.]+(?:x[0-9.]+)*)\s*([a-z]+)", word)
    numbers = SHAPES[shape][0]
    if not match or match[2] not in METRES or len(match[1].split("x")) != len(numbers):
        allowed = f"a colour, or the size of a {shape}: {' x '.join(numbers)} with a unit, such as "
        raise BadParameter("--object", text, allowed + "x".join(map(str, USUAL_MM[shape])) + "mm")
    return tuple(float(value) * METRES[match[2]] for value in match[1].split("x"))


def _speed(text: str) -> float:
    metres, slash, second = text.rpartition("/")
    if not slash or second.strip() != "s":
        raise BadParameter("--belt-speed", text, "a length a second, such as 60mm/s")
    return quantity(metres, "m", "--belt-speed")


def _of_recipe(name: str, seed: int, speed: float | None) -> World:
    """Things, table and light of a recipe of `vr synth`; what moves there lies still here, but on a belt."""
    from vision_robot_synth.recipe import read_recipe
    from vision_robot_synth.scene.scene import scene_of

    design: Any = scene_of(read_recipe(name), seed).design
    items = [replace(item, path=None, fixed=item.fixed and not item.tracked) for item in design.items]
    wanted = [item for item in items if item.tracked]
    if not wanted:
        raise BadParameter("--recipe", name, "one with a tracked thing to be picked")
    rest = [item for item in items if item is not wanted[0]]
    on_belt = design.belt is not None
    things = [wanted[0]] if on_belt else [wanted[0], *rest]
    if on_belt and speed is None:
        speed = design.belt.speed_m_s
    world = scene_named("conveyor" if on_belt else "table", things, belt_speed_m_s=speed)
    table = replace(world.design.table, surface=design.table.surface, colour=design.table.colour)
    return replace(world, design=replace(world.design, table=table, lights=design.lights))


def _faulty(world: World, text: str) -> World:
    name, _, value = text.partition("=")
    name = name.strip()
    if name == "lens":
        return with_lens(world, value.strip())
    unit = FAULTS[name].unit if name in FAULTS else ""
    return with_fault(world, name, quantity(value, unit, f"--fault {name}"))
