"""OpenGL underneath the pictures: one context, two drawing buffers, a MuJoCo scene seen through a pinhole."""

from typing import Any, TypeAlias

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera
from vision_robot.sim.gl import load_mujoco
from vision_robot.types import Array, Float, Image, Int, Integer

__all__ = ["Canvas", "Region"]

# mujoco's own classes, which carry no type information.
MjModel: TypeAlias = Any
MjData: TypeAlias = Any
MjvGLCamera: TypeAlias = Any
MjrContext: TypeAlias = Any
MjrRect: TypeAlias = Any

Region: TypeAlias = tuple[int, int, int, int]
"""A rectangle of a picture: first column, first row, columns, rows."""


class Canvas:
    """Draws the present state of a simulation, in colours or in the numbers of its geoms.

    Colours go to a buffer with several samples per pixel. Numbers and depth go to another without,
    made when first asked for: a number is then that of the pixel's centre, at a fraction of the time,
    and depth comes with it from the same draw.
    """

    def __init__(self, model: MjModel, data: MjData, *, multisamples: int, shadows: bool):
        self._mujoco = mj = load_mujoco()
        self._model, self._data, self._shadows = model, data, shadows
        self._multisamples = multisamples
        self._buffers: dict[str, MjrContext] = {}
        self._tables: dict[tuple[tuple[int, ...], int], Int[Array, "k 2"]] = {}
        self._gl: Any = mj.GLContext(64, 64)
        self._gl.make_current()
        self._scene = mj.MjvScene(model, maxgeom=max(1000, 4 * model.ngeom))
        # Exact pictures hold bodies and sky only.
        self._scene.flags[mj.mjtRndFlag.mjRND_HAZE] = False
        self._scene.flags[mj.mjtRndFlag.mjRND_REFLECTION] = False
        self._options = mj.MjvOption()
        self._shown = np.array(self._options.geomgroup)
        self._buffer("colours")

    def colours(
        self,
        face: Camera,
        world_from_cam: SE3,
        *,
        hidden_groups: tuple[int, ...] = (),
        region: Region | None = None,
    ) -> Image:
        """Red-green-blue picture, or the `region` of it, its lowest row first as OpenGL has it."""
        name = "colours" if region is None else "colours of a region"
        rect = self._draw(name, face, world_from_cam, hidden_groups, region)
        rgb = np.empty((rect.height, rect.width, 3), dtype=np.uint8)
        self._mujoco.mjr_readPixels(rgb, None, rect, self._buffers[name])
        return rgb

    def numbers(
        self,
        face: Camera,
        world_from_cam: SE3,
        *,
        hidden_groups: tuple[int, ...] = (),
        depth: bool = False,
        region: Region | None = None,
    ) -> tuple[Integer[Array, "rows columns"], Float[Array, "rows columns"] | None]:
        """The scene's numbers at the pixels' centres and, if asked for, depth [m], upper row first.

        0 is nothing, `objects` tells about the others; depth is infinite where nothing is hit. Geoms
        of `hidden_groups` are left out.
        """
        name = "numbers" if region is None else "numbers of a region"
        rect = self._draw(name, face, world_from_cam, hidden_groups, region)
        rgb = np.empty((rect.height, rect.width, 3), dtype=np.uint8)
        raw = np.empty((rect.height, rect.width), dtype=np.float32) if depth else None
        self._mujoco.mjr_readPixels(rgb, raw, rect, self._buffers[name])
        index = rgb[::-1, :, 0]
        if self._scene.ngeom > 254:
            parts = rgb[::-1].astype(np.int32)
            index = parts[..., 0] + (parts[..., 1] << 8) + (parts[..., 2] << 16)
        return index, None if raw is None else self._metres(raw[::-1])

    def objects(self, hidden_groups: tuple[int, ...] = ()) -> Int[Array, "k 2"]:
        """Object id and type (`mujoco.mjtObj`) behind each number of the last draw; (-1, -1) for none."""
        key = (hidden_groups, self._scene.ngeom)
        if key not in self._tables:
            table = np.full((self._scene.ngeom + 1, 2), -1, dtype=np.int64)
            for geom in self._scene.geoms[: self._scene.ngeom]:
                if geom.segid >= 0:
                    table[geom.segid + 1] = geom.objid, geom.objtype
            self._tables[key] = table
        return self._tables[key]

    def close(self) -> None:
        """Free the OpenGL context; nothing can be drawn afterwards."""
        if self._gl is not None:
            self._gl.make_current()
            for buffer in self._buffers.values():
                buffer.free()
            self._buffers = {}
            self._gl.free()
            self._gl = None

    def _buffer(self, name: str) -> MjrContext:
        if name not in self._buffers:
            mj, quality = self._mujoco, self._model.vis.quality
            before = int(quality.offsamples), int(quality.shadowsize)
            # What a buffer is like is read from the model when it is made.
            coded = name.startswith("numbers")
            quality.offsamples = 0 if coded else self._multisamples
            if coded or not self._shadows:
                quality.shadowsize = 0
            buffer = mj.MjrContext(self._model, mj.mjtFontScale.mjFONTSCALE_100.value)
            quality.offsamples, quality.shadowsize = before
            buffer.readDepthMap = mj.mjtDepthMap.mjDEPTH_ZEROFAR
            self._buffers[name] = buffer
        return self._buffers[name]

    def _draw(
        self,
        name: str,
        face: Camera,
        world_from_cam: SE3,
        hidden_groups: tuple[int, ...],
        region: Region | None,
    ) -> MjrRect:
        """Draw the picture, or a region of it, into the buffer of that name; answers where it lies there."""
        if self._gl is None:
            raise BadParameter("renderer", "closed", "open: use it inside its with block")
        mj, scene = self._mujoco, self._scene
        left, top, columns, rows = region or (0, 0, face.width, face.height)
        self._gl.make_current()
        buffer = self._buffer(name)
        if region is not None:
            mj.mjr_resizeOffscreen(columns, rows, buffer)  # what is larger would be drawn too
        elif columns > buffer.offWidth or rows > buffer.offHeight:
            mj.mjr_resizeOffscreen(max(columns, buffer.offWidth), max(rows, buffer.offHeight), buffer)
        mj.mjr_setBuffer(mj.mjtFramebuffer.mjFB_OFFSCREEN.value, buffer)
        coded = name.startswith("numbers")
        flags, flag = scene.flags, mj.mjtRndFlag
        flags[flag.mjRND_SEGMENT] = flags[flag.mjRND_IDCOLOR] = coded
        flags[flag.mjRND_SKYBOX] = not coded
        flags[flag.mjRND_SHADOW] = self._shadows and not coded
        self._options.geomgroup = self._shown
        for group in hidden_groups:
            self._options.geomgroup[group] = 0
        everything = mj.mjtCatBit.mjCAT_ALL.value
        mj.mjv_updateScene(self._model, self._data, self._options, None, mj.MjvCamera(), everything, scene)
        for eye in scene.camera:
            _aim(eye, face, world_from_cam)
        for light in scene.lights[: scene.nlight]:
            if light.headlight:
                light.pos, light.dir = world_from_cam.translation, world_from_cam.rotation[:, 2]
        # The whole picture's view port, shifted: what lies outside the buffer is not drawn.
        mj.mjr_render(mj.MjrRect(-left, top + rows - face.height, face.width, face.height), scene, buffer)
        return mj.MjrRect(0, 0, columns, rows)

    def _metres(self, raw: Float[Array, "rows columns"]) -> Float[Array, "rows columns"]:
        eye = self._scene.camera[0]
        near, far = float(eye.frustum_near), float(eye.frustum_far)
        # MuJoCo reverses z: the buffer holds 1 at the near plane and 0 at the far one.
        with np.errstate(divide="ignore"):
            metres = np.float32(near * far) / (np.float32(near) + raw * np.float32(far - near))
        metres[raw <= 0] = np.inf
        return metres


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
