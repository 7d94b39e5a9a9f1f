"""A recipe that has been read: tables of checked values, and the dial that turns some of them."""

import copy
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from vision_robot.errors import BadParameter, BadRecipe
from vision_robot_synth.recipe.parts import (
    PARTS,
    ArmPart,
    BeltPart,
    BoardPart,
    CameraPart,
    LightPart,
    TablePart,
    ThingPart,
    TruthPart,
    VideoPart,
    keys_of,
)  # fmt: skip
from vision_robot_synth.recipe.sensor_keys import SENSOR_KEYS
from vision_robot_synth.sensor import VideoSensor
from vision_robot_synth.sensor.chance import Purpose, generator

__all__ = ["Recipe", "drawn"]

Part = TypeVar("Part")


@dataclass(frozen=True)
class Recipe:
    """What a dataset is to show. Values may still be ranges; `drawn` takes one of each."""

    name: str
    tree: Mapping[str, Any]
    """Checked values, table by table; what is left out has the default of its part."""
    dial: Mapping[str, tuple[Any, Any]]
    """Path of a value -> what it is at severity 0 and at 1."""

    def at(self, severity: float) -> "Recipe":
        """The recipe with its dial turned to `severity`, from 0 to 1. Raises BadParameter outside."""
        if not 0 <= severity <= 1:
            raise BadParameter("severity", severity, "from 0 to 1")
        tree = copy.deepcopy(dict(self.tree))
        for path, (low, high) in self.dial.items():
            *tables, key = path.split(".")
            place: Any = tree
            for table in tables:
                place = place.setdefault(table, {})
            place[key] = _kind(tables, key).between(low, high, severity)
        return Recipe(self.name, tree, {})

    def with_video(self, *, frames: int | None = None, size: tuple[int, int] | None = None) -> "Recipe":
        """The recipe with other frames or another size, where they are given."""
        keys = keys_of(VideoPart)
        given = {key: value for key, value in (("frames", frames), ("size", size)) if value is not None}
        for key, value in given.items():
            if keys[key].kind.checked(value) is None:
                raise BadParameter(f"--{key}", value, keys[key].kind.allowed)
        return replace(self, tree={**self.tree, **given})

    @property
    def video(self) -> VideoPart:
        """The keys before the first table."""
        keys = keys_of(VideoPart)
        return VideoPart(**{key: value for key, value in self.tree.items() if key in keys})

    @property
    def camera(self) -> CameraPart:
        """[camera]."""
        return CameraPart(**self.tree.get("camera", {}))

    @property
    def table(self) -> TablePart:
        """[table]."""
        return TablePart(**self.tree.get("table", {}))

    @property
    def light(self) -> LightPart:
        """[light]."""
        return LightPart(**self.tree.get("light", {}))

    @property
    def arm(self) -> ArmPart | None:
        """[arm]; None without that table."""
        return ArmPart(**self.tree["arm"]) if "arm" in self.tree else None

    @property
    def belt(self) -> BeltPart | None:
        """[belt]; None without that table."""
        return BeltPart(**self.tree["belt"]) if "belt" in self.tree else None

    @property
    def truth(self) -> TruthPart:
        """[truth]."""
        return TruthPart(**self.tree.get("truth", {}))

    @property
    def board(self) -> BoardPart:
        """[board]."""
        return BoardPart(**self.tree.get("board", {}))

    @property
    def things(self) -> dict[str, ThingPart]:
        """[things.NAME]."""
        return {name: ThingPart(**values) for name, values in self.tree["things"].items()}

    def sensor(self, seed: int) -> VideoSensor:
        """[sensor], values drawn."""
        values = {}
        for name, value in self.tree["sensor"].items():
            values[name] = SENSOR_KEYS[name].kind.drawn(value, _generator(seed, f"sensor.{name}", 0))
        try:
            return VideoSensor(**values)
        except BadParameter as error:
            raise BadRecipe(self.name, str(error)) from error


def drawn(part: Part, seed: int, where: str, index: int = 0) -> Part:
    """The part with one value drawn from each of its ranges.

    Every key has a stream of its own: changing one range leaves what is drawn from the others.
    """
    values = {}
    for name, key in keys_of(type(part)).items():
        values[name] = key.kind.drawn(getattr(part, name), _generator(seed, f"{where}.{name}", index))
    return type(part)(**values)


def _generator(seed: int, path: str, index: int) -> Any:
    return generator(seed, Purpose.VALUES, zlib.crc32(path.encode()) * 1024 + index)


def _kind(tables: list[str], key: str) -> Any:
    if tables == ["sensor"]:
        return SENSOR_KEYS[key].kind
    part = {**PARTS, "things": ThingPart, "": VideoPart}[tables[0] if tables else ""]
    return keys_of(part)[key].kind
