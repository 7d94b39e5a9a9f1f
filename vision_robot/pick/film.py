"""An episode filmed: the fixed camera's picture, what the controller believes drawn in, and a side view."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vision_robot.geometry import Camera
from vision_robot.pick.episode import Episode, axis_angle, miss_of
from vision_robot.pick.film_drawing import GOAL, SEEN, TOOL, WIDTH, beside, cross, outline
from vision_robot.pick.hand_label import HandLabel, label_of
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.look import Eye
from vision_robot.pick.player import Player
from vision_robot.pick.sighting import Sighting
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import look_at
from vision_robot.types import Array, Float, Image

__all__ = ["FPS", "Film", "Stills", "Still", "film_size"]

FPS = 15.0

LAST_S = 1.5
"""How long the last picture stands, with what came of it."""

SIDE = look_at(
    Camera(WIDTH, 180, 250.0, 250.0, 119.5, 89.5),
    (-0.42, -0.42, 0.30),
    (0.02, -0.02, 0.05),
    up=(0.0, 0.0, 1.0),
)
"""The inset's view, low from the side: how high the tool is over the thing."""

CARRYING = ("lift", "carry", "put down", "back")
"""Phases in which the thing is off its place: its error is then to the goal."""


@dataclass(frozen=True)
class _Scene:
    """What there is to be drawn."""

    cell: Cell
    eye: Eye
    player: Player
    believed: Knowledge
    where: Sighting
    episode: Episode

    @property
    def told(self) -> Float[Array, "n"]:
        """What the encoders say at this moment."""
        return self.player.world.told_joints(self.cell.joints)

    @cached_property
    def label(self) -> HandLabel | None:
        """The label on the hand, where there is one."""
        mount = self.player.world.design.arm
        return label_of(self.believed.arm, mount) if mount is not None and mount.label is not None else None


@dataclass(frozen=True)
class Still:
    """One picture of a film."""

    phase: str
    """What had just been done."""
    time_s: float
    said: tuple[str, ...]
    """The true errors of that moment."""
    image: Image
    """The fixed camera's picture, marked."""


class Film:
    """A witness that gives a picture to `sink` for each 1/fps of simulated time."""

    def __init__(self, sink: Callable[[Image], None], fps: float = FPS):
        self._sink, self._fps = sink, fps
        self._scene: _Scene | None = None
        self._plain: Image | None = None

    def begins(
        self, cell: Cell, eye: Eye, player: Player, believed: Knowledge, where: Sighting, episode: Episode
    ) -> None:
        """Start filming."""
        self._scene = scene = _Scene(cell, eye, player, believed, where, episode)
        for _ in range(round(self._fps * 0.6)):
            self._sink(_picture(scene, "seen"))
        cell.watch(1 / self._fps, lambda: self._sink(_picture(scene, player.phase)))

    def unseen(self, cell: Cell, eye: Eye) -> None:
        """Nothing to film but an empty look."""
        self._plain = beside(eye.plain(), eye.through(SIDE), "nothing seen", [], cell.time_s)

    def ends(self, episode: Episode) -> None:
        """The outcome, standing for a moment."""
        last = self._plain
        if self._scene is not None:
            self._scene.cell.watch(1.0, None)
            last = _picture(self._scene, _outcome(episode))
        if last is not None:
            for _ in range(round(self._fps * LAST_S)):
                self._sink(last)


class Stills:
    """A witness that keeps one picture of the end of each phase: a film on one strip."""

    def __init__(self) -> None:
        self.pictures: list[Still] = []
        self._scene: _Scene | None = None
        self._phase = "seen"

    def begins(
        self, cell: Cell, eye: Eye, player: Player, believed: Knowledge, where: Sighting, episode: Episode
    ) -> None:
        """The first picture is what was seen."""
        self._scene = _Scene(cell, eye, player, believed, where, episode)
        self._keep()
        cell.watch(0.02, self._look)

    def unseen(self, cell: Cell, eye: Eye) -> None:
        """The empty look."""
        self.pictures.append(Still("nothing seen", cell.time_s, (), eye.plain().copy()))

    def ends(self, episode: Episode) -> None:
        """The outcome."""
        if self._scene is not None:
            self._scene.cell.watch(1.0, None)
            self._phase = _outcome(episode)
            self._keep()

    def _look(self) -> None:
        assert self._scene is not None, "watched from the beginning on"
        now = self._scene.player.phase
        if now != self._phase:
            if self._phase != "seen":
                self._keep()
            self._phase = now

    def _keep(self) -> None:
        scene, phase = self._scene, self._phase
        assert scene is not None, "watched from the beginning on"
        said = tuple(_errors(scene, phase))
        self.pictures.append(Still(phase, scene.cell.time_s, said, _marked(scene, phase)))


def film_size(camera: Camera) -> tuple[int, int]:
    """(width, height) of the film's pictures [px], even as some codecs want it."""
    return camera.width + camera.width % 2 + WIDTH, camera.height + camera.height % 2


def _picture(scene: _Scene, phase: str) -> Image:
    """One picture of the film."""
    cell, side = scene.cell, scene.eye.through(SIDE)
    return beside(_marked(scene, phase), side, phase, _errors(scene, phase), cell.time_s)


def _marked(scene: _Scene, phase: str) -> Image:
    """The fixed camera's picture, with what is believed drawn in."""
    believed, where = scene.believed, scene.where
    image, plane = scene.eye.plain().copy(), believed.plane

    def at(places_m: Float[Array, "n 2"], z_m: float) -> Float[Array, "n 2"]:
        return plane.pixels(places_m, z_m=z_m)

    size = scene.player.world.design.items[0].size_m
    goal = scene.episode.station_from_place
    yaw = axis_angle(goal.rotation, 0)
    outline(image, at(_rectangle(goal.translation[:2], yaw, size[0], size[-1]), 0.0), GOAL)
    if not _moved(phase):
        outline(
            image, at(_rectangle(where.position_m, where.yaw_rad, size[0], size[-1]), where.height_m), SEEN
        )
        cross(image, at(where.position_m[None], where.height_m)[0], SEEN)
    told = believed.base_from_station.inverse() @ believed.arm.chain.base_from_tool(scene.told)
    cross(image, at(told.translation[None, :2], float(told.translation[2]))[0], TOOL, turned=True)
    if scene.label is not None:
        corners = scene.label.corners_in_station(believed, scene.told)
        outline(image, plane.camera.project(plane.cam_from_station.apply(corners)), TOOL)
    return image


def _moved(phase: str) -> bool:
    """Whether the thing is taken off its place, at least in the arm's mind."""
    return phase in CARRYING or phase.startswith(("lifted", "placed"))


def _errors(scene: _Scene, phase: str) -> list[str]:
    """The true errors of this moment, in words."""
    cell = scene.cell
    thing, tool = cell.station_from(scene.episode.thing), cell.station_from_tool
    goal = scene.episode.station_from_place
    if _moved(phase):
        miss = miss_of(goal, thing.translation, axis_angle(thing.rotation, 0))
        return [f"thing {_mm(miss.position_m)} from goal", f"turned {np.degrees(miss.yaw_rad):+.1f} deg"]
    miss = miss_of(thing, tool.translation, axis_angle(tool.rotation, 1))
    off = scene.where.position_m - thing.translation[:2]
    said = [f"seen {_mm(float(np.linalg.norm(off)))} off"]
    if phase != "seen":
        said += [f"tool {_mm(miss.position_m)} off", f"{1000 * miss.height_m:.0f} mm over it"]
    return [*said, scene.player.remark] if scene.player.remark else said


def _mm(metres: float) -> str:
    return f"{1000 * metres:.{1 if metres < 0.1 else 0}f} mm"


def _outcome(episode: Episode) -> str:
    if episode.placed:
        return "placed"
    words = episode.rung or "not seen"
    return f"{words}, no further" if not episode.failure else f"{words}; gave up"


def _rectangle(
    middle_m: Float[Array, "2"], yaw_rad: float, length_m: float, width_m: float
) -> Float[Array, "4 2"]:
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    corners = 0.5 * np.array(
        [[-length_m, -width_m], [length_m, -width_m], [length_m, width_m], [-length_m, width_m]]
    )
    return middle_m + corners @ np.array([[c, s], [-s, c]])
