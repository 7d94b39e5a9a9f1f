"""Looking at the table: frames of the cell's camera through a tracker."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vision_robot.errors import NothingSeen
from vision_robot.geometry import SE3
from vision_robot.pick.sighting import Seen
from vision_robot.pick.world import World
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import StationCamera
from vision_robot.sim.truth import TruthRenderer
from vision_robot.track.blobs import Blobs
from vision_robot.track.tracker import Tracker
from vision_robot.types import Image

__all__ = ["Arrival", "Eye", "look"]

AWAY = SE3(np.eye(3), np.array([0.0, 0.0, 5.0]))
"""Where an object waits before it arrives: behind the camera."""


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


ARRIVALS = {
    "rgb": Arrival(empty=0, sliding=0),
    "rgb-plain": Arrival(empty=0, sliding=0),
    "background": Arrival(sliding=0),
    "background-plain": Arrival(sliding=0),
}
"""What of it a kind of tracker needs to see; others see all of it."""


class Eye:
    """The cell's camera as it stands now, with the noise of its sensor."""

    def __init__(self, cell: Cell, world: World, seed: int):
        self._renderer = TruthRenderer(cell, world.view_now)
        self._noise, self._rng = world.image_noise, np.random.default_rng([seed, 2])

    def picture(self) -> Image:
        """What the controller gets to see."""
        return self._spoilt(self._renderer.picture())

    def plain(self) -> Image:
        """The same without the sensor's noise, for who only watches: no chance is used up."""
        return self._renderer.picture()

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
    cell: Cell, eye: Eye, tracker: Tracker, name: str, world: World, arrival: Arrival | None = None
) -> Seen:
    """Show the tracker how the thing called `name` arrives, and take what it says in the end.

    Raises NothingSeen where it says nothing. Of several blobs the surest and largest is taken.
    """
    blobs = Blobs.empty()
    for k, image in enumerate(_arriving(cell, eye, name, arrival or ARRIVALS.get(tracker.name, Arrival()))):
        blobs = tracker.step(image, k / world.frame_rate)
    if not len(blobs):
        raise NothingSeen(tracker.name, name)
    best = int(np.argmax(blobs.score * np.sqrt(blobs.area_px)))
    return Seen(blobs.centroid_px[best], float(blobs.yaw_rad[best]), float(blobs.axes_px[best, 0]))


def _arriving(cell: Cell, eye: Eye, name: str, arrival: Arrival) -> Iterator[Image]:
    there = cell.station_from(name)
    along = there.rotation[:, 1] * arrival.distance_m
    cell.place(name, AWAY @ there)
    for _ in range(arrival.empty):
        yield eye.picture()
    for k in range(arrival.sliding):
        share = 1 - (k + 1) / arrival.sliding
        cell.place(name, SE3(there.rotation, there.translation + share * along))
        yield eye.picture()
    cell.place(name, there)
    for _ in range(arrival.still):
        yield eye.picture()
