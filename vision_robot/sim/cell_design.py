"""What a cell holds: table, things on it, lights, arm and belt, as plain data."""

from dataclasses import dataclass, field, replace
from pathlib import Path as FilePath

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera
from vision_robot.sim.paths import Path

__all__ = ["ArmMount", "Belt", "CellDesign", "Colour", "Item", "Lights", "StationCamera", "Table", "look_at"]

Colour = tuple[float, float, float]
"""Red, green, blue from 0 to 1."""

SURFACES = ("plain", "wood", "speckled", "checked")


@dataclass(frozen=True)
class Item:
    """A thing on the table.

    `shape` is one of `vision_robot.sim.shapes.SHAPES`; `size_m` is (length, diameter) for pencil, rod
    and hexagon, (x, y, z) for a box, (diameter, thickness) for a disc. The item's own frame has its
    origin at the middle, x along the length, z up as it lies. It starts at `x_m`, `y_m`, `yaw_rad`
    in {S}, `above_m` over the table. Without a `path` it is free to roll, be pushed and be grasped;
    with one it is moved exactly along it and pushes others. `fixed` nails it down.
    `tracked` items are what the truth tells about; the others are clutter.
    """

    name: str
    shape: str = "pencil"
    size_m: tuple[float, ...] = (0.14, 0.008)
    colour: Colour = (0.85, 0.16, 0.12)
    x_m: float = 0.0
    y_m: float = 0.0
    yaw_rad: float = 0.0
    above_m: float = 0.0
    path: Path | None = None
    fixed: bool = False
    tracked: bool = True
    glossy: float = 0.3
    """Strength of highlights, 0 to 1."""

    def __post_init__(self) -> None:
        from vision_robot.sim.shapes import shape_named

        for name in ("size_m", "colour"):  # lists come from TOML
            object.__setattr__(self, name, tuple(getattr(self, name)))
        shape_named(self.shape, self.size_m, self.colour)  # refuses what cannot be made
        _colour(f"colour of {self.name}", self.colour)
        if self.fixed and self.path is not None:
            raise BadParameter(f"item {self.name}", "fixed, with a path", "one of the two")

    def moved_to(self, x_m: float, y_m: float, yaw_rad: float = 0.0) -> "Item":
        """The same item starting elsewhere."""
        return replace(self, x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)


@dataclass(frozen=True)
class Table:
    """The table; its top is Z = 0 of {S}, {S}'s origin is `middle_m` away from its middle."""

    size_m: tuple[float, float] = (1.2, 1.0)
    middle_m: tuple[float, float] = (0.0, 0.0)
    surface: str = "wood"
    """One of `SURFACES`."""
    colour: Colour = (0.72, 0.58, 0.42)
    seed: int = 0
    """Of the surface's grain."""

    def __post_init__(self) -> None:
        _colour("colour of the table", self.colour)
        if self.surface not in SURFACES:
            raise BadParameter("surface of the table", self.surface, f"one of {', '.join(SURFACES)}")
        if not min(self.size_m) > 0:
            raise BadParameter("size of the table", self.size_m, "positive")


@dataclass(frozen=True)
class Lights:
    """A key light from one direction, which alone casts shadows, and light from everywhere."""

    azimuth_rad: float = 2.2
    """Where the key light stands, about {S}'s z from its x."""
    elevation_rad: float = 1.2
    """How high it stands. At 1.05 it grazes the flanks of six-sided pencils, which shadow maps speckle."""
    key: float = 0.5
    ambient: float = 0.5
    shadows: bool = True
    shadow_px: int = 2048
    """Side of the shadow map; its cost is the cost of shadows."""


@dataclass(frozen=True)
class ArmMount:
    """An arm from an MJCF file, where it stands and what its hand is marked with.

    The file must have a site "tool"; joints and actuators are found in it. The label (O12) is a
    plate standing off the hand, seen from above; None leaves it out.
    """

    mjcf: FilePath | None = None
    """None: the project's own `column_arm.xml`."""
    label: Colour | None = (0.95, 0.1, 0.75)
    label_m: tuple[float, float] = (0.036, 0.036)
    """Size of the label."""
    start: tuple[float, ...] | None = None
    """Joint values [m, rad] at the start; None: a pose out of the way."""
    tool: str = "tool"
    """Site between the fingers."""
    tool_turn_rad: float = 0.0
    """Turn about that site's z to {T}, whose x is the direction in which the fingers close."""
    balanced: bool = False
    """Whether drives that hold the arm against its weight are added to the file's own."""


@dataclass(frozen=True)
class Belt:
    """A conveyor let into the table, along {S}'s y from edge to edge; it carries what lies on it."""

    speed_m_s: float = 0.05
    """Towards +y."""
    x_m: float = 0.0
    width_m: float = 0.2
    colour: Colour = (0.2, 0.21, 0.23)

    def __post_init__(self) -> None:
        _colour("colour of the belt", self.colour)
        if not self.width_m > 0:
            raise BadParameter("width of the belt", self.width_m, "positive")


@dataclass(frozen=True)
class StationCamera:
    """A camera that stands still in the cell: intrinsics and cam_from_station."""

    camera: Camera
    cam_from_station: SE3
    name: str = "camera"


@dataclass(frozen=True)
class CellDesign:
    """Everything a cell is built from; a pure function of it and of the time gives every picture."""

    items: tuple[Item, ...] = ()
    table: Table = field(default_factory=Table)
    lights: Lights = field(default_factory=Lights)
    arm: ArmMount | None = None
    belt: Belt | None = None
    base_from_station: SE3 = field(
        default_factory=lambda: SE3(np.eye(3), np.array([0.36, 0.0, 0.07])), compare=False
    )
    """Where {S} lies in {B}; MuJoCo's world is {B}, with or without an arm."""
    timestep_s: float = 0.002
    scatter_m: tuple[float, float, float, float] = (-0.12, -0.16, 0.12, 0.16)
    """Least x and y, greatest x and y in {S} between which `Cell.reset(seed)` scatters free items."""

    def __post_init__(self) -> None:
        names = [item.name for item in self.items]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise BadParameter("names of items", twice, "different from each other")


def look_at(
    camera: Camera,
    eye_m: tuple[float, float, float],
    target_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
    *,
    up: tuple[float, float, float] = (1.0, 0.0, 0.0),
    name: str = "camera",
) -> StationCamera:
    """A camera at `eye_m` that looks at `target_m`, both in {S}; `up` of {S} is up in the picture."""
    eye, ahead = np.array(eye_m, dtype=float), np.array(target_m, dtype=float) - np.array(eye_m, dtype=float)
    right = np.cross(ahead, np.array(up, dtype=float))
    if np.linalg.norm(right) < 1e-9 * max(np.linalg.norm(ahead), 1e-9):
        raise BadParameter("up of the camera", up, "across its line of sight")
    z, x = ahead / np.linalg.norm(ahead), right / np.linalg.norm(right)
    station_from_cam = SE3(np.stack([x, np.cross(z, x), z], axis=1), eye)
    return StationCamera(camera, station_from_cam.inverse(), name)


def _colour(name: str, colour: Colour) -> None:
    value = np.asarray(colour, dtype=float)
    if value.shape != (3,) or not ((value >= 0) & (value <= 1)).all():
        raise BadParameter(name, colour, "red, green, blue from 0 to 1")
