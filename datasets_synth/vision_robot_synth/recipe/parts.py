"""The keys of a recipe, table by table: what each may be, its default and what it does.

This is the only place where keys are named; reading, refusing, `vr synth --keys` and the
severity dial all go by it.
"""

from dataclasses import dataclass, field, fields
from typing import Any

from vision_robot_synth.recipe.colours import RGB
from vision_robot_synth.recipe.kinds import Choice, Colour, Flag, Kind, Number, Numbers, Text, Whole
from vision_robot_synth.scene.motions import MOTIONS
from vision_robot_synth.sensor import VideoSensor

__all__ = ["PARTS", "SENSOR_KEYS", "ArmPart", "BeltPart", "BoardPart", "CameraPart", "Draw", "LightPart",
           "TablePart", "ThingPart", "TruthPart", "VideoPart", "keys_of"]

Draw = float | tuple[float, float]
"""A number, or a range to draw from."""


def key(default: Any, kind: Kind, text: str) -> Any:
    """A field with its kind and its explanation."""
    return field(default=default, metadata={"kind": kind, "text": text})


@dataclass(frozen=True)
class VideoPart:
    """The keys before the first table."""

    description: str = key("", Text(), "one line of what the dataset is for")
    kind: str = key("video", Choice(("video", "views")), "a video of the cell, or single views of a board")
    frames: int = key(120, Whole(1, 1_000_000, ranged=False), "frames of the video, or views")
    fps: float = key(30.0, Number(0.1, 1000, ranged=False), "frames a second")
    size: tuple[int, int] = key((640, 480), Numbers((2,), 16, whole=True), "width and height [px]")


@dataclass(frozen=True)
class CameraPart:
    """[camera]: where it stands and its lens."""

    height_mm: Draw = key(700.0, Number(100, 5000), "height over the table")
    tilt_deg: Draw = key(0.0, Number(0, 75), "angle between the line of sight and straight down")
    turn_deg: Draw = key(0.0, Number(-180, 180), "direction from which it looks, about the vertical")
    field_mm: Draw = key(480.0, Number(20, 10_000), "width of the table that fits into the picture, at its middle")
    off_centre: float = key(0.02, Number(0, 0.2, ranged=False), "distance of the principal point from the middle, in widths")
    lens: str = key("pinhole", Choice(("pinhole", "brown5", "brown8", "fisheye")), "model of the lens")
    distortion: tuple[float, ...] = key((), Numbers((0, 4, 5, 8)), "coefficients of the lens")
    shake_mm: Draw = key(0.0, Number(0, 100), "standard deviation of a shaking camera's place")
    shake_deg: Draw = key(0.0, Number(0, 10), "standard deviation of its direction")
    shake_period_s: float = key(0.35, Number(0.02, 60, ranged=False), "period of the fastest part of the shaking")


@dataclass(frozen=True)
class TablePart:
    """[table]."""

    surface: str = key("plain", Choice(("plain", "wood", "speckled", "checked")), "what its top looks like")
    colour: tuple[RGB, ...] = key(((0.62, 0.60, 0.56),), Colour(), "its colour")


@dataclass(frozen=True)
class LightPart:
    """[light]: a key light that casts shadows, and light from everywhere."""

    azimuth_deg: Draw = key(125.0, Number(-360, 360), "where the key light stands")
    elevation_deg: Draw = key(60.0, Number(5, 90), "how high it stands")
    strength: Draw = key(0.55, Number(0, 2), "the key light")
    ambient: Draw = key(0.4, Number(0, 2), "the light from everywhere")
    shadows: bool = key(True, Flag(), "whether the key light casts shadows")
    drift: Draw = key(0.0, Number(0, 2), "standard deviation of the logarithm of all light as it wanders")
    drift_period_s: float = key(3.0, Number(0.05, 1000, ranged=False), "period of the fastest part of that")
    swing_deg: Draw = key(0.0, Number(0, 180), "how far the key light swings to both sides, and its shadows with it")
    swing_period_s: float = key(4.0, Number(0.05, 1000, ranged=False), "time of one swing to and fro")


@dataclass(frozen=True)
class ArmPart:
    """[arm]: left out, there is no arm."""

    label: tuple[RGB, ...] = key(((0.90, 0.12, 0.62),), Colour(optional=True), "colour of the label on its hand")
    task: str = key("approach", Choice(("approach", "pick", "rest")), "approach: comes down to the thing `towards`; "
                    "pick: and takes it away; rest: stands still")
    towards: str = key("", Text(), "name of the thing it goes to; else the first")
    speed_mm_s: Draw = key(150.0, Number(5, 2000), "speed of its tool")


@dataclass(frozen=True)
class BeltPart:
    """[belt]: left out, there is no conveyor."""

    speed_mm_s: Draw = key(80.0, Number(0, 5000), "speed along the picture")
    width_mm: float = key(180.0, Number(20, 2000, ranged=False), "width")
    colour: tuple[RGB, ...] = key(((0.22, 0.23, 0.25),), Colour(), "its colour")


@dataclass(frozen=True)
class ThingPart:
    """[things.NAME]: one or several things of one kind."""

    count: int | tuple[int, int] = key(1, Whole(0, 500), "how many")
    shape: str = key("rod", Choice(("pencil", "rod", "hexagon", "box", "disc")), "what they are")
    length_mm: Draw = key((110.0, 160.0), Number(1, 2000), "length; diameter of a disc")
    width_mm: Draw = key((8.0, 10.0), Number(1, 2000), "thickness of a rod, pencil or hexagon; width of a box")
    height_mm: Draw = key((8.0, 16.0), Number(1, 2000), "height of a box or disc")
    colour: tuple[RGB, ...] = key(((0.82, 0.14, 0.10),), Colour(), "colour, or colours to take in turn")
    colour_spread: float = key(0.0, Number(0, 1, ranged=False), "how far each may be off that")
    gloss: Draw = key(0.2, Number(0, 1), "strength of highlights")
    motion: str = key("rest", Choice(tuple(MOTIONS)), "; ".join(f"{k}: {m.text}" for k, m in MOTIONS.items()))
    speed_mm_s: Draw = key((60.0, 120.0), Number(0, 10_000), "speed")
    spin_deg_s: Draw = key((-40.0, 40.0), Number(-3600, 3600), "how fast they turn")
    pause_s: Draw = key(1.0, Number(0, 1000), "how long one stands still, where its motion has pauses")
    above_mm: Draw = key(0.0, Number(0, 1000), "how high over the table they are carried; things of one height keep clear of "
                         "each other")
    area: float = key(0.8, Number(0.05, 3, ranged=False), "part of the picture they keep to, about its middle")
    tracked: bool = key(True, Flag(), "whether they are objects, or clutter of which the truth says nothing")


@dataclass(frozen=True)
class TruthPart:
    """[truth]: what is written besides the tracks."""

    masks: bool = key(True, Flag(), "pictures of ids")
    coco: bool = key(True, Flag(), "the masks as COCO keeps them too")
    flow: str = key("png", Choice(("none", "png", "flo")), "true optical flow: KITTI's 16-bit PNG, or .flo")
    flow_step: int = key(1, Whole(1, 100, ranged=False), "frames from one end of the flow to the other")


@dataclass(frozen=True)
class BoardPart:
    """[board]: the target of kind "views"."""

    name: str = key("chessboard", Choice(("chessboard", "charuco", "circles", "acircles", "aprilgrid")), "its kind")
    size: tuple[int, int] = key((9, 6), Numbers((2,), 2, whole=True), "across and down, as `vr board --size`")
    square_mm: float = key(25.0, Number(1, 1000, ranged=False), "side of a square, or pitch")


PARTS: dict[str, type] = {
    "camera": CameraPart,
    "table": TablePart,
    "light": LightPart,
    "arm": ArmPart,
    "belt": BeltPart,
    "truth": TruthPart,
    "board": BoardPart,
}

_LIMITS = {"jpeg": Whole(0, 100), **dict.fromkeys(("shutter", "vignetting", "flicker", "shade", "dropped"), Number(0, 0.999))}
_TEXTS = {
    "blur_px": "standard deviation of the optics' blur", "defocus_px": "radius of the disc of a point out of focus",
    "shutter": "part of the time between frames in which light is gathered (motion blur)",
    "vignetting": "part of the light lost in the corners", "exposure_drift": "sd of the log of the exposure",
    "white_balance_drift": "sd of the log of the gains of red and blue", "drift_period_s": "period of their fastest part",
    "flicker": "depth of the bands of a flickering lamp", "flicker_hz": "frequency of its light",
    "readout_s": "time in which a rolling shutter passes over all rows",
    "shade": "part of the light a wandering shade takes away", "shade_period_s": "period of its fastest part",
    "shot_noise": "variance of the photons' noise per grey value", "read_noise": "sd of the read-out's noise [grey values]",
    "jpeg": "quality of a compression, 0 for none", "dropped": "probability that a frame repeats the one before",
}  # fmt: skip
SENSOR_KEYS: dict[str, tuple[Kind, str]] = {
    one.name: (_LIMITS.get(one.name, Number(0)), _TEXTS[one.name]) for one in fields(VideoSensor)
}
"""[sensor]: the effects of `VideoSensor`."""


def keys_of(part: type) -> dict[str, tuple[Kind, Any, str]]:
    """Kind, default and explanation of each key of a part."""
    return {one.name: (one.metadata["kind"], one.default, one.metadata["text"]) for one in fields(part)}
