"""MuJoCo pictures, depth and object ids through any camera of this library."""

from typing import Any, Self, TypeAlias

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera
from vision_robot.sim.cover import PinholeCover
from vision_robot.sim.gl import load_mujoco
from vision_robot.types import Array, Float, Image, Int

__all__ = ["Renderer"]

# mujoco's own classes, which carry no type information.
MjModel: TypeAlias = Any
MjData: TypeAlias = Any
MjvGLCamera: TypeAlias = Any
MjrRect: TypeAlias = Any


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
        self._mujoco = mj = load_mujoco()
        self._model, self._data = model, data
        self._covers: dict[Camera, PinholeCover] = {}
        self._context: Any = None
        self._gl: Any = mj.GLContext(64, 64)
        self._gl.make_current()
        model.vis.quality.offsamples = multisamples
        self._context = mj.MjrContext(model, mj.mjtFontScale.mjFONTSCALE_100.value)
        self._context.readDepthMap = mj.mjtDepthMap.mjDEPTH_ZEROFAR
        mj.mjr_setBuffer(mj.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        self._scene = mj.MjvScene(model, maxgeom=max(1000, 4 * model.ngeom))
        self._scene.flags[mj.mjtRndFlag.mjRND_SHADOW] = shadows
        # Exact pictures hold bodies and sky only.
        self._scene.flags[mj.mjtRndFlag.mjRND_HAZE] = False
        self._scene.flags[mj.mjtRndFlag.mjRND_REFLECTION] = False
        self._options = mj.MjvOption()

    def render(self, camera: Camera, world_from_cam: SE3, *, grey: bool = False) -> Image:
        """Blue-green-red picture (height, width, 3), or grey (height, width) on request.

        Black where the lens sees nothing.
        """
        if _straight(camera):
            return self._colours(camera, world_from_cam, SE3.identity(), grey=grey)
        cover = self._cover(camera)
        return cover.assemble(
            [self._colours(face, world_from_cam, turn, grey=grey) for face, turn in cover.faces]
        )

    def depth(self, camera: Camera, world_from_cam: SE3) -> Float[Array, "height width"]:
        """Distance along the optical axis [m], the z in the camera frame, at each pixel centre.

        Infinite where nothing is hit, NaN where the lens sees nothing; negative behind a fisheye.
        """
        if _straight(camera):
            return self._depths(camera, world_from_cam, SE3.identity())
        cover = self._cover(camera)
        return cover.assemble_depth([self._depths(face, world_from_cam, turn) for face, turn in cover.faces])

    def segmentation(self, camera: Camera, world_from_cam: SE3) -> Int[Array, "height width 2"]:
        """Object id and object type (`mujoco.mjtObj`) seen at each pixel centre, (-1, -1) for none."""
        if _straight(camera):
            return self._ids(camera, world_from_cam, SE3.identity())
        cover = self._cover(camera)
        return cover.assemble_ids([self._ids(face, world_from_cam, turn) for face, turn in cover.faces])

    def close(self) -> None:
        """Free the OpenGL context; the renderer cannot be used afterwards."""
        if self._context is not None:
            self._gl.make_current()
            self._context.free()
            self._context = None
        if self._gl is not None:
            self._gl.free()
            self._gl = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _cover(self, camera: Camera) -> PinholeCover:
        if camera not in self._covers:
            self._covers = {camera: PinholeCover.of(camera)}  # maps are large: keep the last one only
        return self._covers[camera]

    def _draw(self, face: Camera, world_from_cam: SE3, turn: SE3, *, ids: bool) -> MjrRect:
        """Draw the scene through a pinhole, cam_from_face = `turn`, into the off-screen buffer."""
        if self._context is None:
            raise BadParameter("renderer", "closed", "open: use it inside its with block")
        mj, scene = self._mujoco, self._scene
        self._gl.make_current()
        if face.width > self._context.offWidth or face.height > self._context.offHeight:
            size = (max(face.width, self._context.offWidth), max(face.height, self._context.offHeight))
            mj.mjr_resizeOffscreen(*size, self._context)
        scene.flags[mj.mjtRndFlag.mjRND_SEGMENT] = scene.flags[mj.mjtRndFlag.mjRND_IDCOLOR] = ids
        everything = mj.mjtCatBit.mjCAT_ALL.value
        mj.mjv_updateScene(self._model, self._data, self._options, None, mj.MjvCamera(), everything, scene)
        for eye in scene.camera:
            _aim(eye, face, world_from_cam @ turn)
        for light in scene.lights[: scene.nlight]:
            if light.headlight:
                light.pos, light.dir = world_from_cam.translation, world_from_cam.rotation[:, 2]
        rect = mj.MjrRect(0, 0, face.width, face.height)
        mj.mjr_render(rect, scene, self._context)
        return rect

    def _colours(self, face: Camera, world_from_cam: SE3, turn: SE3, *, grey: bool) -> Image:
        rgb = self._read_rgb(self._draw(face, world_from_cam, turn, ids=False))
        # OpenGL's first row is the lowest.
        return cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY if grey else cv2.COLOR_RGB2BGR)[::-1]

    def _read_rgb(self, rect: MjrRect) -> Image:
        rgb = np.empty((rect.height, rect.width, 3), dtype=np.uint8)
        self._mujoco.mjr_readPixels(rgb, None, rect, self._context)
        return rgb

    def _depths(self, face: Camera, world_from_cam: SE3, turn: SE3) -> Float[Array, "height width"]:
        rect = self._draw(face, world_from_cam, turn, ids=True)
        raw = np.empty((rect.height, rect.width), dtype=np.float32)
        self._mujoco.mjr_readPixels(None, raw, rect, self._context)
        eye = self._scene.camera[0]
        near, far = float(eye.frustum_near), float(eye.frustum_far)
        # MuJoCo reverses z: the buffer holds 1 at the near plane and 0 at the far one.
        value = raw[::-1].astype(float)
        with np.errstate(divide="ignore"):
            return np.where(value > 0, near * far / (near + value * (far - near)), np.inf)

    def _ids(self, face: Camera, world_from_cam: SE3, turn: SE3) -> Int[Array, "height width 2"]:
        rect = self._draw(face, world_from_cam, turn, ids=True)
        rgb = self._read_rgb(rect)[::-1].astype(np.int64)
        index = rgb[..., 0] + (rgb[..., 1] << 8) + (rgb[..., 2] << 16)
        table = np.full((self._scene.ngeom + 1, 2), -1, dtype=np.int64)
        for geom in self._scene.geoms[: self._scene.ngeom]:
            if geom.segid >= 0:
                table[geom.segid + 1] = geom.objid, geom.objtype
        return table[index]


def _straight(camera: Camera) -> bool:
    """Whether OpenGL itself can project like this camera."""
    return camera.model == "pinhole" and camera.skew == 0


def _aim(eye: MjvGLCamera, camera: Camera, world_from_cam: SE3) -> None:
    """Set an OpenGL camera; the picture's border lies half a pixel outside the outer pixel centres."""
    R = world_from_cam.rotation
    eye.pos, eye.forward, eye.up = world_from_cam.translation, R[:, 2], -R[:, 1]
    near = float(eye.frustum_near)
    left, right = near * (-0.5 - camera.cx) / camera.fx, near * (camera.width - 0.5 - camera.cx) / camera.fx
    top, bottom = near * (-0.5 - camera.cy) / camera.fy, near * (camera.height - 0.5 - camera.cy) / camera.fy
    eye.frustum_center = (left + right) / 2
    eye.frustum_width = (right - left) / 2  # half of it, despite its name
    eye.frustum_bottom, eye.frustum_top = -bottom, -top
    eye.orthographic = 0
