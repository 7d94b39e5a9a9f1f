"""The keys of a recipe, table by table: what each may be, its default and what it does.

This is the only place where keys are named; reading, refusing, `vr synth --keys` and the
severity dial all go by it.
"""

from dataclasses import dataclass, fields
from functools import cache
from typing import Annotated, Any, NamedTuple, get_type_hints

from vision_robot_synth.recipe.colours import RGB
from vision_robot_synth.recipe.kinds import Choice, Colour, Flag, Kind, Number, Numbers, Text, Whole
from vision_robot_synth.scene.motions import MOTIONS

__all__ = [
    "PARTS",
    "ArmPart",
    "BeltPart",
    "BoardPart",
    "CameraPart",
    "Draw",
    "Key",
    "LightPart",
    "TablePart",
    "ThingPart",
    "TruthPart",
    "VideoPart",
    "keys_of",
]

Draw = float | tuple[float, float]
"""A number, or a range to draw from."""


@dataclass(frozen=True)
class VideoPart:
    """The keys before the first table."""

    description: Annotated[str, Text(), "one line of what the dataset is for"] = ""
    kind: Annotated[str, Choice(("video", "views")), "a video of the cell, or single views of a board"] = (
        "video"
    )
    frames: Annotated[int, Whole(1, 1_000_000, ranged=False), "frames of the video, or views"] = 120
    fps: Annotated[float, Number(0.1, 1000, ranged=False), "frames a second"] = 30.0
    size: Annotated[tuple[int, int], Numbers((2,), 16, whole=True, most=16384), "width and height [px]"] = (
        640,
        480,
    )


@dataclass(frozen=True)
class CameraPart:
    """[camera]: where it stands and its lens."""

    height_mm: Annotated[Draw, Number(100, 5000), "height over the table"] = 700.0
    tilt_deg: Annotated[Draw, Number(0, 75), "angle between the line of sight and straight down"] = 0.0
    turn_deg: Annotated[Draw, Number(-180, 180), "direction from which it looks, about the vertical"] = 0.0
    field_mm: Annotated[
        Draw, Number(20, 10_000), "width of the table that fits into the picture, at its middle"
    ] = 480.0
    off_centre: Annotated[
        float, Number(0, 0.2, ranged=False), "distance of the principal point from the middle, in widths"
    ] = 0.02
    lens: Annotated[str, Choice(("pinhole", "brown5", "brown8", "fisheye")), "model of the lens"] = "pinhole"
    distortion: Annotated[tuple[float, ...], Numbers((0, 4, 5, 8)), "coefficients of the lens"] = ()
    shake_mm: Annotated[Draw, Number(0, 100), "standard deviation of a shaking camera's place"] = 0.0
    shake_deg: Annotated[Draw, Number(0, 10), "standard deviation of its direction"] = 0.0
    shake_period_s: Annotated[
        float, Number(0.02, 60, ranged=False), "period of the fastest part of the shaking"
    ] = 0.35


@dataclass(frozen=True)
class TablePart:
    """[table]."""

    surface: Annotated[str, Choice(("plain", "wood", "speckled", "checked")), "what its top looks like"] = (
        "plain"
    )
    colour: Annotated[tuple[RGB, ...], Colour(), "its colour"] = ((0.62, 0.60, 0.56),)


@dataclass(frozen=True)
class LightPart:
    """[light]: a key light that casts shadows, and light from everywhere."""

    azimuth_deg: Annotated[Draw, Number(-360, 360), "where the key light stands"] = 125.0
    elevation_deg: Annotated[Draw, Number(5, 90), "how high it stands"] = 60.0
    strength: Annotated[Draw, Number(0, 2), "the key light"] = 0.55
    ambient: Annotated[Draw, Number(0, 2), "the light from everywhere"] = 0.4
    shadows: Annotated[bool, Flag(), "whether the key light casts shadows"] = True
    drift: Annotated[Draw, Number(0, 2), "standard deviation of the logarithm of all light as it wanders"] = (
        0.0
    )
    drift_period_s: Annotated[
        float, Number(0.05, 1000, ranged=False), "period of the fastest part of that"
    ] = 3.0
    swing_deg: Annotated[
        Draw, Number(0, 180), "how far the key light swings to both sides, and its shadows with it"
    ] = 0.0
    swing_period_s: Annotated[float, Number(0.05, 1000, ranged=False), "time of one swing to and fro"] = 4.0


@dataclass(frozen=True)
class ArmPart:
    """[arm]: left out, there is no arm."""

    label: Annotated[tuple[RGB, ...], Colour(optional=True), "colour of the label on its hand"] = (
        (0.90, 0.12, 0.62),
    )
    task: Annotated[
        str,
        Choice(("approach", "pick", "rest")),
        "approach: comes down to the thing `towards`; pick: and puts it down aside; rest: stands still",
    ] = "approach"
    towards: Annotated[str, Text(), "name of the thing it goes to; else the first"] = ""
    speed_mm_s: Annotated[Draw, Number(5, 2000), "speed of its tool"] = 150.0


@dataclass(frozen=True)
class BeltPart:
    """[belt]: left out, there is no conveyor."""

    speed_mm_s: Annotated[Draw, Number(0, 5000), "speed along the picture"] = 80.0
    width_mm: Annotated[float, Number(20, 2000, ranged=False), "width"] = 180.0
    colour: Annotated[tuple[RGB, ...], Colour(), "its colour"] = ((0.22, 0.23, 0.25),)


@dataclass(frozen=True)
class ThingPart:
    """[things.NAME]: one or several things of one kind."""

    count: Annotated[int | tuple[int, int], Whole(0, 500), "how many"] = 1
    shape: Annotated[str, Choice(("pencil", "rod", "hexagon", "box", "disc")), "what they are"] = "rod"
    length_mm: Annotated[Draw, Number(1, 2000), "length; diameter of a disc"] = (110.0, 160.0)
    width_mm: Annotated[Draw, Number(1, 2000), "thickness of a rod, pencil or hexagon; width of a box"] = (
        8.0,
        10.0,
    )
    height_mm: Annotated[Draw, Number(1, 2000), "height of a box or disc"] = (8.0, 16.0)
    colour: Annotated[tuple[RGB, ...], Colour(), "colour, or colours to take in turn"] = ((0.82, 0.14, 0.10),)
    colour_spread: Annotated[float, Number(0, 1, ranged=False), "how far each may be off that"] = 0.0
    gloss: Annotated[Draw, Number(0, 1), "strength of highlights"] = 0.2
    motion: Annotated[
        str, Choice(tuple(MOTIONS)), "; ".join(f"{k}: {m.text}" for k, m in MOTIONS.items())
    ] = "rest"
    speed_mm_s: Annotated[Draw, Number(0, 10_000), "speed"] = (60.0, 120.0)
    spin_deg_s: Annotated[Draw, Number(-3600, 3600), "how fast they turn"] = (-40.0, 40.0)
    pause_s: Annotated[Draw, Number(0, 1000), "how long one stands still, where its motion has pauses"] = 1.0
    above_mm: Annotated[
        Draw,
        Number(0, 1000),
        "how high over the table they are carried; things of one height keep clear of each other",
    ] = 0.0
    area: Annotated[
        float, Number(0.05, 3, ranged=False), "part of the picture they keep to, about its middle"
    ] = 0.8
    tracked: Annotated[
        bool, Flag(), "whether they are objects, or clutter of which the truth says nothing"
    ] = True


@dataclass(frozen=True)
class TruthPart:
    """[truth]: what is written besides the tracks."""

    masks: Annotated[bool, Flag(), "pictures of ids"] = True
    coco: Annotated[bool, Flag(), "the masks as COCO keeps them too"] = True
    flow: Annotated[str, Choice(("none", "png", "flo")), "true optical flow: KITTI's 16-bit PNG, or .flo"] = (
        "png"
    )
    flow_step: Annotated[int, Whole(1, 100, ranged=False), "frames from one end of the flow to the other"] = 1


@dataclass(frozen=True)
class BoardPart:
    """[board]: the target of kind "views"."""

    name: Annotated[
        str, Choice(("chessboard", "charuco", "circles", "acircles", "aprilgrid")), "its kind"
    ] = "chessboard"
    size: Annotated[
        tuple[int, int], Numbers((2,), 2, whole=True), "across and down, as `vr board --size`"
    ] = (9, 6)
    square_mm: Annotated[float, Number(1, 1000, ranged=False), "side of a square, or pitch"] = 25.0


PARTS: dict[str, type] = {
    "camera": CameraPart,
    "table": TablePart,
    "light": LightPart,
    "arm": ArmPart,
    "belt": BeltPart,
    "truth": TruthPart,
    "board": BoardPart,
}


class Key(NamedTuple):
    """What one key of a recipe is."""

    kind: Kind
    default: Any
    text: str


@cache
def keys_of(part: type) -> dict[str, Key]:
    """The keys of a part by name."""
    hints = get_type_hints(part, include_extras=True)
    keys = {}
    for one in fields(part):
        kind, text = hints[one.name].__metadata__
        keys[one.name] = Key(kind, one.default, text)
    return keys
