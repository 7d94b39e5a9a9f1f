"""A recipe made concrete: the cell, the camera and everything that changes with time."""

import zlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter, BadRecipe
from vision_robot.geometry import SE3
from vision_robot.sim.cell_design import ArmMount, Belt, CellDesign, Item, Lights, StationCamera, Table
from vision_robot.sim.paths import Path
from vision_robot.types import Array, Float
from vision_robot_synth.recipe import Recipe
from vision_robot_synth.recipe.colours import RGB
from vision_robot_synth.recipe.parts import ArmPart, BeltPart, ThingPart
from vision_robot_synth.recipe.recipe import drawn
from vision_robot_synth.scene.area import Area
from vision_robot_synth.scene.lamp import Lamp
from vision_robot_synth.scene.motions import MOTIONS, Mover
from vision_robot_synth.scene.traffic import Footprint, Traffic
from vision_robot_synth.scene.view import Shake, view_of
from vision_robot_synth.sensor import VideoSensor
from vision_robot_synth.sensor.chance import Purpose, generator

__all__ = ["Scene", "scene_of"]

TABLE_MARGIN_M = 0.25
EXPOSURE_STEP_PX = 1.5
MOST_EXPOSURES = 15


@dataclass(frozen=True)
class Scene:
    """Everything that determines the frames of a dataset."""

    recipe: Recipe
    seed: int
    design: CellDesign
    view: StationCamera
    shake: Shake
    lamp: Lamp
    sensor: VideoSensor
    arm: ArmPart | None
    exposures: int
    """Moments of each frame's open shutter, an odd number."""

    @property
    def is_planned(self) -> bool:
        """Whether every motion is known from the time alone, without physics."""
        loose = any(item.path is None and not item.fixed for item in self.design.items)
        return not loose and self.arm is None

    def cam_from_station(self, frame: int) -> SE3:
        """Where the station stands before the camera at the middle of a frame's exposure."""
        return self.shake.cam_from_station(self.view.cam_from_station, frame / self.recipe.video.fps)


def scene_of(recipe: Recipe, seed: int) -> Scene:
    """The scene of a recipe at a seed; the same for the same. Raises BadRecipe where it cannot be made."""
    video, camera = recipe.video, drawn(recipe.camera, seed, "camera")
    view = view_of(camera, video.size, recipe.name)
    lamp = Lamp(drawn(recipe.light, seed, "light"), seed)
    belt = recipe.belt and drawn(recipe.belt, seed, "belt")
    arm = recipe.arm and drawn(recipe.arm, seed, "arm")
    try:
        items = tuple(_items(recipe, seed, view, belt))
        design = CellDesign(
            items=items,
            table=_table(recipe, seed, view),
            lights=_lights(lamp),
            arm=_mount(arm),
            belt=belt
            and Belt(_number(belt.speed_mm_s) / 1e3, width_m=belt.width_mm / 1e3, colour=belt.colour[0]),
        )
    except BadParameter as error:
        raise BadRecipe(recipe.name, str(error)) from error
    tremble = _number(camera.shake_mm) / 1e3, float(np.deg2rad(_number(camera.shake_deg)))
    shake = Shake(*tremble, camera.shake_period_s, seed)
    sensor = recipe.sensor(seed)
    exposures = _exposures(items, shake, view, sensor.shutter / video.fps, video.frames / video.fps)
    return Scene(recipe, seed, design, view, shake, lamp, sensor, arm, exposures)


def _items(recipe: Recipe, seed: int, view: StationCamera, belt: BeltPart | None) -> Iterator[Item]:
    duration = recipe.video.frames / recipe.video.fps + 1
    traffic = Traffic(duration)
    for name, ranges in recipe.things.items():
        first = drawn(ranges, seed, f"things.{name}")
        count = first.count
        assert isinstance(count, int), "drawn"
        for i in range(count):
            part = drawn(ranges, seed, f"things.{name}", i)
            motion = MOTIONS[part.motion]
            mover = _mover(part, view, belt, traffic, (i, count), _generator(seed, name, i))
            path = motion.path(mover)
            traffic.add(mover.footprint, traffic.places(path))
            yield _item(name if count == 1 else f"{name} {i + 1}", part, path, _colour(part, i, seed, name))


def _mover(
    part: ThingPart,
    view: StationCamera,
    belt: BeltPart | None,
    traffic: Traffic,
    rank: tuple[int, int],
    rng: np.random.Generator,
) -> Mover:
    size = _size(part)
    width = size[0] if part.shape == "disc" else size[1]
    return Mover(
        footprint=Footprint(size[0], width, _number(part.above_mm) / 1e3),
        speed_m_s=_number(part.speed_mm_s) / 1e3,
        spin_rad_s=float(np.deg2rad(_number(part.spin_deg_s))),
        pause_s=_number(part.pause_s),
        area=Area(view, part.area),
        traffic=traffic,
        rank=rank[0],
        count=rank[1],
        belt_speed_m_s=_number(belt.speed_mm_s) / 1e3 if belt else 0.0,
        belt_x_m=Belt().x_m,
        rng=rng,
    )


def _item(name: str, part: ThingPart, path: Path, colour: RGB) -> Item:
    motion = MOTIONS[part.motion]
    x, y, above, yaw = (float(value) for value in path.at(0.0))
    still = motion.lies or motion.free
    return Item(
        name,
        part.shape,
        _size(part),
        colour,
        x_m=x,
        y_m=y,
        yaw_rad=yaw,
        above_m=above,
        path=None if still else path,
        fixed=motion.lies,
        tracked=part.tracked,
        glossy=_number(part.gloss),
    )


def _size(part: ThingPart) -> tuple[float, ...]:
    length, width, height = (_number(v) / 1e3 for v in (part.length_mm, part.width_mm, part.height_mm))
    return {"box": (length, width, height), "disc": (length, height)}.get(part.shape, (length, width))


def _colour(part: ThingPart, rank: int, seed: int, name: str) -> RGB:
    base = np.array(part.colour[rank % len(part.colour)])
    rng = generator(seed, Purpose.SCENE, zlib.crc32(f"{name}.colour".encode()) * 1024 + rank)
    red, green, blue = np.clip(base + part.colour_spread * rng.uniform(-1, 1, 3), 0, 1).tolist()
    return red, green, blue


def _table(recipe: Recipe, seed: int, view: StationCamera) -> Table:
    """A table that fills the picture."""
    corners = Area(view, 1.0).places(np.array([[0, 0], [1, 0], [1, 1], [0, 1]]))
    reach = np.nan_to_num(np.abs(corners).max(axis=0), nan=1.5) + TABLE_MARGIN_M
    width, depth = np.clip(2 * reach, 0.8, 4.0).tolist()
    return Table((width, depth), surface=recipe.table.surface, colour=recipe.table.colour[0], seed=seed)


def _lights(lamp: Lamp) -> Lights:
    part = lamp.part
    azimuth, elevation = (float(np.deg2rad(_number(v))) for v in (part.azimuth_deg, part.elevation_deg))
    return Lights(azimuth, elevation, _number(part.strength), _number(part.ambient), part.shadows)


def _mount(arm: ArmPart | None) -> ArmMount | None:
    return None if arm is None else ArmMount(label=arm.label[0] if arm.label else None)


def _exposures(
    items: tuple[Item, ...], shake: Shake, view: StationCamera, open_s: float, duration_s: float
) -> int:
    """So many moments that nothing moves much more than a pixel from one to the next."""
    if open_s == 0:
        return 1
    times = np.linspace(0, duration_s, 50)
    scale = view.camera.fx / float(np.linalg.norm(view.cam_from_station.translation))
    fastest = (
        6 * view.camera.fx * shake.turn_rad / shake.period_s + 6 * scale * shake.place_m / shake.period_s
    )
    for item in items:
        if item.path is not None:
            rates: Float[Array, "times 4"] = np.array([item.path.rate(float(time)) for time in times])
            turning = np.abs(rates[:, 3]) * max(item.size_m) / 2
            fastest = max(fastest, scale * float((np.linalg.norm(rates[:, :2], axis=1) + turning).max()))
    count = int(np.ceil(fastest * open_s / EXPOSURE_STEP_PX)) | 1
    return int(np.clip(count, 3, MOST_EXPOSURES))


def _number(value: float | tuple[float, float]) -> float:
    assert not isinstance(value, tuple), "drawn"
    return float(value)


def _generator(seed: int, name: str, index: int) -> np.random.Generator:
    return generator(seed, Purpose.SCENE, zlib.crc32(name.encode()) * 1024 + index)
