"""MuJoCo pictures, depth and object ids through any camera of this library."""

from functools import lru_cache
from typing import Any, Self, TypeAlias

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera
from vision_robot.sim.canvas import Canvas, Region
from vision_robot.sim.cover import PinholeCover
from vision_robot.sim.gl import load_mujoco
from vision_robot.types import Array, Float, Image, Int, Integer, UInt8

__all__ = ["Renderer", "straight"]

# mujoco's own classes, which carry no type information.
MjModel: TypeAlias = Any
MjData: TypeAlias = Any


class Renderer:
    """Renders the present state of a MuJoCo simulation through a `Camera`.

    A pinhole camera without skew is rendered straight, whatever its principal point and
    focal lengths. Any other camera is resampled from pinhole pictures which cover its field
    (`PinholeCover`). Use it as a context manager, so that its OpenGL context is closed:

        with Renderer(model, data) as renderer:
            image = renderer.render(camera, world_from_cam)

    `multisamples` is the number of samples per pixel at the edges of bodies; the model's
    own setting is overridden. Raises MissingOpenGL where nothing can render.
    """

    def __init__(self, model: MjModel, data: MjData, *, multisamples: int = 4, shadows: bool = False):
        if multisamples not in (0, 2, 4, 8, 16):
            raise BadParameter("multisamples", multisamples, "0, 2, 4, 8 or 16")
        self._covers: dict[Camera, PinholeCover] = {}
        self._geom_body = np.array(model.geom_bodyid)
        self._canvas = Canvas(model, data, multisamples=multisamples, shadows=shadows)

    def render(
        self,
        camera: Camera,
        world_from_cam: SE3,
        *,
        grey: bool = False,
        hidden_groups: tuple[int, ...] = (),
        region: Region | None = None,
    ) -> Image:
        """Blue-green-red picture (height, width, 3), or grey (height, width) on request.

        Black where the lens sees nothing. Geoms of `hidden_groups` are left out. Of a pinhole camera's
        picture a `region` alone may be asked for, in less time.
        """
        if straight(camera):
            rgb = self._canvas.colours(camera, world_from_cam, hidden_groups=hidden_groups, region=region)
            return _upright(rgb, grey=grey)
        if region is not None:
            raise BadParameter("region", region, "left out for a camera with a lens or skew")
        cover = self._cover(camera)
        return cover.assemble(
            [
                _upright(
                    self._canvas.colours(face, world_from_cam @ turn, hidden_groups=hidden_groups), grey=grey
                )
                for face, turn in cover.faces
            ]
        )

    def depth(self, camera: Camera, world_from_cam: SE3) -> Float[Array, "height width"]:
        """Distance along the optical axis [m], the z in the camera frame, at each pixel centre.

        Infinite where nothing is hit, NaN where the lens sees nothing; negative behind a fisheye.
        """
        depth = self._coded(camera, world_from_cam, (), depth=True)[2]
        assert depth is not None
        return depth

    def segmentation(self, camera: Camera, world_from_cam: SE3) -> Int[Array, "height width 2"]:
        """Object id and object type (`mujoco.mjtObj`) seen at each pixel centre, (-1, -1) for none."""
        number, objects, _ = self._coded(camera, world_from_cam, (), depth=False)
        return objects[number]

    def bodies(
        self,
        camera: Camera,
        world_from_cam: SE3,
        *,
        hidden_groups: tuple[int, ...] = (),
        depth: bool = False,
        region: Region | None = None,
    ) -> tuple[Integer[Array, "height width"], Float[Array, "height width"] | None]:
        """The body seen at each pixel centre, from 1 (0: none), and depth [m] if asked for, in one draw.

        Geoms of `hidden_groups` are left out, which saves their time. The numbers are of the smallest
        unsigned type that holds them. Of a pinhole camera's picture a `region` alone may be asked for.
        """
        number, objects, metres = self._coded(
            camera, world_from_cam, hidden_groups, depth=depth, region=region
        )
        geom = load_mujoco().mjtObj.mjOBJ_GEOM.value
        table = np.zeros(256 if number.dtype == np.uint8 else len(objects), dtype=np.int64)
        isgeom = objects[:, 1] == geom
        table[: len(objects)][isgeom] = self._geom_body[objects[isgeom, 0]] + 1
        kind = np.uint8 if table.max() < 256 else np.uint16
        if number.dtype == kind == np.uint8:
            return cv2.LUT(number, table.astype(np.uint8)), metres
        return table.astype(kind)[number], metres

    def close(self) -> None:
        """Free the OpenGL context; the renderer cannot be used afterwards."""
        self._canvas.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _cover(self, camera: Camera) -> PinholeCover:
        if camera not in self._covers:
            self._covers = {camera: _cover_of(camera)}
        return self._covers[camera]

    def _coded(
        self,
        camera: Camera,
        world_from_cam: SE3,
        hidden_groups: tuple[int, ...] = (),
        *,
        depth: bool,
        region: Region | None = None,
    ) -> tuple[Integer[Array, "height width"], Int[Array, "k 2"], Float[Array, "height width"] | None]:
        """Number at each pixel centre, object and type behind each number, depth if asked for."""
        canvas = self._canvas
        if straight(camera):
            number, metres = canvas.numbers(
                camera, world_from_cam, hidden_groups=hidden_groups, depth=depth, region=region
            )
            return number, canvas.objects(hidden_groups), metres
        if region is not None:
            raise BadParameter("region", region, "left out for a camera with a lens or skew")
        cover = self._cover(camera)
        drawn = [
            canvas.numbers(face, world_from_cam @ turn, hidden_groups=hidden_groups, depth=depth)
            for face, turn in cover.faces
        ]
        number = cover.assemble_numbers([number for number, _ in drawn])
        metres = None
        if depth:
            metres = cover.assemble_depth([m for _, m in drawn if m is not None], [n for n, _ in drawn])
        return number, canvas.objects(hidden_groups), metres


@lru_cache(maxsize=1)  # maps are large: only the last camera's are kept
def _cover_of(camera: Camera) -> PinholeCover:
    return PinholeCover.of(camera)


def _upright(rgb: UInt8[Array, "height width 3"], *, grey: bool) -> Image:
    # OpenGL's first row is the lowest.
    return cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY if grey else cv2.COLOR_RGB2BGR)[::-1]


def straight(camera: Camera) -> bool:
    """Whether OpenGL itself can project like this camera."""
    return camera.model == "pinhole" and camera.skew == 0
