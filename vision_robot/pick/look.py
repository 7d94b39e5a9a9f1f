"""Looking at the table: frames of the cell's camera through a tracker."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.errors import NothingSeen, VisionRobotError
from vision_robot.geometry import SE3, WorkPlane
from vision_robot.pick.sighting import Seen, expected_axes_px
from vision_robot.pick.world import World
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import Item, StationCamera
from vision_robot.sim.shapes import shape_named
from vision_robot.sim.truth import TruthRenderer
from vision_robot.track.blobs import Blobs
from vision_robot.track.tracker import Tracker
from vision_robot.types import Array, Float, Image

__all__ = ["Arrival", "LIES", "Eye", "Survey", "look", "recognised", "survey"]

AWAY = SE3(np.eye(3), np.array([0.0, 0.0, 5.0]))
"""Where objects wait before they arrive: behind the camera."""


@dataclass(frozen=True)
class Arrival:
    """How an object comes onto the table before it is picked.

    First the empty table, which background subtraction learns; then the object slides in, which optical
    flow sees; then it lies still.
    """

    empty: int = 12
    sliding: int = 10
    still: int = 4
    distance_m: float = 0.06


@dataclass(frozen=True)
class Survey:
    """What a tracker says of the thing that is wanted, and of all else that it sees."""

    thing: Seen
    others: tuple[Seen, ...] = ()


LIES = Arrival(empty=0, sliding=0)
"""What lies there already, looked at once more."""

ARRIVALS = {
    "rgb": Arrival(empty=0, sliding=0),
    "rgb-plain": Arrival(empty=0, sliding=0),
    "background": Arrival(sliding=0),
    "background-plain": Arrival(sliding=0),
    "optical-flow-plain": Arrival(empty=0, sliding=12, still=0, distance_m=0.03),
}
"""What of it a kind of tracker needs to see; others see all of it."""


class Eye:
    """The cell's camera as it stands now, with the noise of its sensor."""

    def __init__(self, cell: Cell, world: World, seed: int):
        self._renderer = TruthRenderer(cell, world.view_now)
        self._noise, self._rng = world.image_noise, np.random.default_rng([seed, 2])
        self.frames = 0
        """Pictures taken so far."""
        self._state, self._clean = b"", np.zeros((0, 0, 3), dtype=np.uint8)

    def picture(self) -> Image:
        """What the controller gets to see."""
        self.frames += 1
        return self._spoilt(self.plain())

    def plain(self) -> Image:
        """The same without the sensor's noise, for who only watches: no chance is used up."""
        # Where nothing has moved since the last picture, the same one would be drawn again.
        data = self._renderer.cell.data
        state = data.qpos.tobytes() + data.mocap_pos.tobytes() + data.mocap_quat.tobytes()
        if state != self._state or not self._renderer.cell.light_is_as_designed:
            self._state, self._clean = state, self._renderer.picture()
        return self._clean

    def through(self, view: StationCamera) -> Image:
        """What a camera elsewhere would see, for who only watches."""
        return self._renderer.through(view)

    @property
    def time_s(self) -> float:
        """The moment that a picture would show."""
        return self._renderer.cell.time_s

    def truth_of(self, name: str) -> Seen:
        """Where a thing really is in the picture: the projection of its middle and of its axis."""
        cell, view = self._renderer.cell, self._renderer.view
        pose = view.cam_from_station @ cell.station_from(name)
        ends = pose.apply(np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [-0.01, 0.0, 0.0]]))
        pixels = view.camera.project(ends)
        ahead = pixels[1] - pixels[2]
        # As long as two centimetres of it look: `sighting` wants a length to step along.
        return Seen(pixels[0], float(np.arctan2(ahead[1], ahead[0])), 2 * float(np.linalg.norm(ahead)))

    def close(self) -> None:
        """Free the OpenGL context."""
        self._renderer.close()

    def __enter__(self) -> "Eye":
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _spoilt(self, image: Image) -> Image:
        if self._noise <= 0:
            return image
        noise = self._rng.standard_normal(image.shape, dtype=np.float32) * np.float32(self._noise)
        return np.clip(np.rint(image + noise), 0, 255).astype(np.uint8)


def look(
    cell: Cell,
    eye: Eye,
    tracker: Tracker,
    name: str,
    world: World,
    arrival: Arrival | None = None,
    plane: WorkPlane | None = None,
) -> Seen:
    """What `survey` says of the thing called `name`."""
    return survey(cell, eye, tracker, name, world, arrival, plane).thing


def survey(
    cell: Cell,
    eye: Eye,
    tracker: Tracker,
    name: str,
    world: World,
    arrival: Arrival | None = None,
    plane: WorkPlane | None = None,
) -> Survey:
    """Show the tracker how everything arrives, and take what it says in the end.

    Raises NothingSeen where it says nothing. Which blob is the thing called `name` is told by kind (its
    colour comes first), by how sure and how large it is and, with a `plane`, by whether it has its size.
    """
    blobs = Blobs.empty()
    for image in _arriving(cell, eye, name, arrival or ARRIVALS.get(tracker.name, Arrival())):
        blobs = tracker.step(image, eye.frames / world.frame_rate)
    item = next(one for one in world.design.items if one.name == name)
    return recognised(blobs, tracker.name, item, plane)


def recognised(blobs: Blobs, tracker: str, item: Item, plane: WorkPlane | None) -> Survey:
    """Which of the blobs is the item, and what else was seen. Raises NothingSeen."""
    mine = np.flatnonzero(blobs.kind == 0)
    if not len(mine):
        raise NothingSeen(tracker, item.name)
    hull = shape_named(item.shape, item.size_m, item.colour).hull
    worth = blobs.score * np.sqrt(blobs.area_px)
    if plane is not None and len(mine) > 1:
        worth = blobs.score * np.array([_alike(blobs, k, hull, plane) for k in range(len(blobs))])
    best = int(mine[np.argmax(worth[mine])])
    if plane is not None and _is_cut(blobs.box_px[best], plane):
        raise NothingSeen(tracker, f"{item.name} whole: the picture's border cuts it")
    seen = [
        Seen(
            blobs.centroid_px[k],
            float(blobs.yaw_rad[k]),
            float(blobs.axes_px[k, 0]),
            float(blobs.axes_px[k, 1]),
        )
        for k in range(len(blobs))
    ]
    others = tuple(one for k, one in enumerate(seen) if k != best)
    return Survey(replace(seen[best], hull=hull), others)


def _is_cut(box_px: Float[Array, "4"], plane: WorkPlane) -> bool:
    """Whether a blob touches the picture's border."""
    left, top, width, height = box_px.tolist()
    size = plane.camera
    return left < 0.5 or top < 0.5 or left + width > size.width - 1.5 or top + height > size.height - 1.5


def _alike(blobs: Blobs, index: int, hull: Float[Array, "n 3"], plane: WorkPlane) -> float:
    """From 0 to 1: how well a blob's axes are those of the body lying there."""
    yaw = blobs.yaw_rad[index] if np.isfinite(blobs.yaw_rad[index]) else 0.0
    seen = Seen(blobs.centroid_px[index], float(yaw), float(blobs.axes_px[index, 0]), hull=hull)
    try:
        expected = expected_axes_px(plane, seen, float(-hull[:, 2].min()))
    except VisionRobotError:
        return 0.0
    return float(np.exp(-np.abs(np.log(np.maximum(blobs.axes_px[index], 0.1) / expected)).sum()))


def _arriving(cell: Cell, eye: Eye, name: str, arrival: Arrival) -> Iterator[Image]:
    free = [item.name for item in cell.design.items if item.path is None and not item.fixed]
    there = {one: cell.station_from(one) for one in free}
    along = there[name].rotation[:, 1] * arrival.distance_m
    if arrival.empty:
        for one in free:
            cell.place(one, AWAY @ there[one])
        for _ in range(arrival.empty):
            yield eye.picture()
    for k in range(arrival.sliding):
        share = 1 - (k + 1) / arrival.sliding
        for one in free:  # all together, as on a tray that is pushed in
            pose = there[one]
            cell.place(one, SE3(pose.rotation, pose.translation + share * along))
        yield eye.picture()
    if arrival.empty or arrival.sliding:
        for one in free:
            cell.place(one, there[one])
    for _ in range(arrival.still):
        yield eye.picture()
