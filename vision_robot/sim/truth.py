"""Pictures of a cell with the truth about them: who is where, what is seen of it, and how it moves."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from vision_robot.geometry import SE3, Camera
from vision_robot.sim.canvas import Region
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import StationCamera
from vision_robot.sim.cell_names import BACKGROUND, MOVING
from vision_robot.sim.object_truth import FINER, ObjectTruth, object_truth
from vision_robot.sim.redraw import MovingRegion
from vision_robot.sim.render import Renderer, straight
from vision_robot.types import Array, Float, Image, Integer

__all__ = ["TruthFrame", "TruthRenderer"]

WORTH = 0.7
"""Share of the picture up to which only the region that moves is drawn anew."""


@dataclass(frozen=True)
class TruthFrame:
    """One picture and everything known about it."""

    time_s: float
    camera: Camera
    cam_from_station: SE3
    image: Image
    """Blue-green-red, as an ideal sensor would see it."""
    bodies: Integer[Array, "height width"]
    """MuJoCo's body at each pixel centre, counted from 1; 0: nothing that was drawn."""
    thing_of_body: Integer[Array, "numbers"]
    """Id of the tracked thing behind each number of `bodies`; 0: none."""
    cam_from_body: SE3
    """Pose of every body of the model, a batch; `true_flow` compares two of them."""
    objects: ObjectTruth
    depth: Float[Array, "height width"] | None = None
    """Distance along the optical axis [m] at pixel centres; infinite where nothing is, NaN outside a lens."""

    @property
    def ids(self) -> Integer[Array, "height width"]:
        """Id of the tracked thing (its place in `Cell.tracked`, from 1) at each pixel centre, 0 for none."""
        return self.thing_of_body[self.bodies]


class TruthRenderer:
    """A camera in a cell whose pictures come with the truth.

    Use it as a context manager:

        with TruthRenderer(cell, view) as eye:
            cell.advance(1 / 30)
            frame = eye.frame()

    The colours are drawn once, with shadows if the design has them; all the rest takes one more draw in which
    each body has its number: no light, no shadow, one sample at each pixel centre, and, unless
    `depth` is asked for, without table and floor, which hide nothing. Depth comes from that same draw.
    """

    def __init__(self, cell: Cell, view: StationCamera, *, multisamples: int = 4, depth: bool = False):
        self.cell, self.view, self.depth = cell, view, depth
        shadows = cell.design.lights.shadows
        self._renderer = Renderer(cell.model, cell.data, multisamples=multisamples, shadows=shadows)
        things = np.zeros(cell.model.nbody + 1, dtype=np.uint8 if len(cell.tracked) < 256 else np.uint16)
        things[cell.bodies + 1] = np.arange(1, len(cell.tracked) + 1)
        self._thing_of_body = things
        solid = np.bincount(cell.model.geom_bodyid, cell.model.geom_group != BACKGROUND, cell.model.nbody) > 0
        self._hides = np.concatenate([[False], solid])
        self._moving = MovingRegion(cell)
        self._can_redraw = straight(view.camera) and cell.design.belt is None  # a belt moves all along
        self._still: Image | None = None

    def picture(self, cam_from_station: SE3 | None = None) -> Image:
        """Colours only: blue-green-red, as an ideal sensor would see it."""
        camera, base_from_cam = self.view.camera, self._base_from_cam(cam_from_station)
        if self._can_redraw and cam_from_station is None and self.cell.light_is_as_designed:
            region = self._moving.region(camera, base_from_cam)
            if region is not None and region[2] * region[3] < WORTH * camera.width * camera.height:
                return self._redrawn(base_from_cam, region)
        return self._renderer.render(camera, base_from_cam)

    def through(self, view: StationCamera) -> Image:
        """Colours only, through a camera that stands elsewhere."""
        return self._renderer.render(
            view.camera, self.cell.base_from_station @ view.cam_from_station.inverse()
        )

    def _redrawn(self, base_from_cam: SE3, region: Region) -> Image:
        """The picture of all that stands, drawn once, with the region drawn anew.

        It depends on this moment alone, not on the pictures before it; from a picture drawn as a
        whole it differs by a grey level here and there, where OpenGL rounds otherwise.
        """
        camera = self.view.camera
        if self._still is None:
            self._still = self._renderer.render(camera, base_from_cam, hidden_groups=(MOVING,))
        image = self._still.copy()
        left, top, columns, rows = region
        if columns and rows:
            part = self._renderer.render(camera, base_from_cam, region=region)
            image[top : top + rows, left : left + columns] = part
        return image

    def frame(self, cam_from_station: SE3 | None = None) -> TruthFrame:
        """The picture of this moment and the truth about it, seen from the view's place or another one."""
        cell, camera = self.cell, self.view.camera
        base_from_cam = self._base_from_cam(cam_from_station)
        image = self.picture(cam_from_station)
        fallen = (cell.station_from_tracked().translation[:, 2] < -0.005).any()
        hidden = () if self.depth or fallen else (BACKGROUND,)
        bodies, depth = self._renderer.bodies(camera, base_from_cam, hidden_groups=hidden, depth=self.depth)
        cam_from_body = base_from_cam.inverse() @ cell.base_from_bodies()
        return TruthFrame(
            time_s=cell.time_s,
            camera=camera,
            cam_from_station=self.view.cam_from_station if cam_from_station is None else cam_from_station,
            image=image,
            bodies=bodies,
            thing_of_body=self._thing_of_body,
            cam_from_body=cam_from_body,
            objects=object_truth(
                cell,
                camera,
                cam_from_body[cell.bodies],
                bodies,
                self._hides | fallen,
                self._finer(base_from_cam, hidden) if straight(camera) else None,
            ),
            depth=depth,
        )

    def _finer(
        self, base_from_cam: SE3, hidden_groups: tuple[int, ...]
    ) -> Callable[[Region], Integer[Array, "rows columns"]]:
        """What draws a region of `bodies` with FINER times as many rows and columns."""
        fine = _finer(self.view.camera)

        def draw(region: Region) -> Integer[Array, "rows columns"]:
            left, top, columns, rows = (FINER * value for value in region)
            part = (left, top, columns, rows)
            return self._renderer.bodies(fine, base_from_cam, hidden_groups=hidden_groups, region=part)[0]

        return draw

    def close(self) -> None:
        """Free the OpenGL context."""
        self._renderer.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _base_from_cam(self, cam_from_station: SE3 | None) -> SE3:
        pose = self.view.cam_from_station if cam_from_station is None else cam_from_station
        return self.cell.base_from_station @ pose.inverse()


def _finer(camera: Camera) -> Camera:
    """The same camera with FINER x FINER pixels in the place of each."""
    n = FINER
    return replace(
        camera,
        width=n * camera.width,
        height=n * camera.height,
        fx=n * camera.fx,
        fy=n * camera.fy,
        cx=n * (camera.cx + 0.5) - 0.5,
        cy=n * (camera.cy + 0.5) - 0.5,
    )
