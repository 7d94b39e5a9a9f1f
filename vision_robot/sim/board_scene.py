"""A printed calibration board in MuJoCo, photographed from given poses."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera
from vision_robot.sim.gl import load_mujoco
from vision_robot.sim.render import Renderer
from vision_robot.types import Array, Float, Image, UInt8

__all__ = ["BoardPrint", "render_views"]

THICKNESS_M = 0.002
INK = 25
"""Grey value of black print in the texture: ink is not quite black, and noise needs room below."""

# A thin box, because MuJoCo draws a plane geom 0.07 % too large; turned so that its textured
# upper side looks along -z of the board frame. Head light without specular part: every point
# of the flat face has one brightness, which falls as the board turns away.
SCENE = """
<mujoco model="calibration board">
  <option jacobian="dense"/>
  <statistic extent="1" center="0 0 0"/>
  <visual>
    <headlight ambient="0.35 0.35 0.35" diffuse="0.55 0.55 0.55" specular="0 0 0"/>
  </visual>
  <asset>
    <texture name="backdrop" type="skybox" builtin="flat" width="8" height="8"
             rgb1="0.45 0.45 0.45" rgb2="0.45 0.45 0.45"/>
    <texture name="print" type="2d" builtin="flat" width="{columns}" height="{rows}"/>
    <material name="print" texture="print" specular="0" shininess="0" reflectance="0"/>
  </asset>
  <worldbody>
    <geom name="board" type="box" material="print" quat="0 1 0 0" contype="0" conaffinity="0"
          size="{half_width:.9g} {half_height:.9g} {half_depth:.9g}" pos="{x:.9g} {y:.9g} {half_depth:.9g}"/>
  </worldbody>
</mujoco>
"""


@dataclass(frozen=True)
class BoardPrint:
    """The picture printed on a board and where it lies.

    `picture` (rows, columns) grey, white 255, at `pixels_per_metre`; its top-left corner (the
    border of the first pixel) lies at ``-origin_m`` in the board frame (x right and y down on
    the face, z into the board). Edges fall on pixel borders and stay sharp at every distance
    when the scale puts a power of two of pixels on each square: mipmaps then halve evenly.
    """

    picture: UInt8[Array, "rows columns"]
    pixels_per_metre: float
    origin_m: tuple[float, float]

    def __post_init__(self) -> None:
        picture = np.asarray(self.picture)
        if picture.ndim != 2 or picture.dtype != np.uint8 or not picture.size:
            raise BadParameter(
                "print", f"{picture.dtype} {picture.shape}", "a grey picture, uint8 (rows, columns)"
            )
        if max(picture.shape) > 8192:
            raise BadParameter(
                "print", picture.shape, "at most 8192 pixels a side, what OpenGL textures hold"
            )
        if not (np.isfinite(self.pixels_per_metre) and self.pixels_per_metre > 0):
            raise BadParameter("pixels per metre", self.pixels_per_metre, "positive")
        object.__setattr__(self, "picture", picture)

    @property
    def size_m(self) -> tuple[float, float]:
        """Width and height [m]."""
        rows, columns = self.picture.shape
        return columns / self.pixels_per_metre, rows / self.pixels_per_metre

    @property
    def box_m(self) -> tuple[float, float, float, float]:
        """Left, top, right and bottom of the print in the board frame [m]."""
        (x, y), (width, height) = self.origin_m, self.size_m
        return -x, -y, width - x, height - y


def render_views(
    board: BoardPrint, camera: Camera, cam_from_board: SE3, *, multisamples: int = 4, grey: bool = True
) -> Iterator[Image]:
    """One picture of the board for each pose, in order; grey, or blue-green-red on request.

    The board point p is imaged at ``camera.project(cam_from_board.apply(p))`` within 0.01 px.
    Raises MissingOpenGL where nothing can render.
    """
    mj = load_mujoco()
    model = mj.MjModel.from_xml_string(_scene(board))
    texture = model.texture("print")
    first = int(texture.adr[0])
    shades = np.rint(np.linspace(INK, 255, 256)).astype(np.uint8)[board.picture]
    model.tex_data[first : first + 3 * shades.size] = np.repeat(shades.reshape(-1), 3)
    data = mj.MjData(model)
    mj.mj_forward(model, data)
    world_from_cam, reach = cam_from_board.inverse(), _reach(board, cam_from_board)
    with Renderer(model, data, multisamples=multisamples) as renderer:
        for i in range(len(cam_from_board)):
            # Set for each view from that view alone: pictures do not depend on their neighbours.
            model.vis.map.znear, model.vis.map.zfar = 0.02 * reach[i], 4 * reach[i]
            yield renderer.render(camera, world_from_cam[i], grey=grey)


def _scene(board: BoardPrint) -> str:
    left, top, right, bottom = board.box_m
    rows, columns = board.picture.shape
    return SCENE.format(
        columns=columns,
        rows=rows,
        half_width=(right - left) / 2,
        half_height=(bottom - top) / 2,
        half_depth=THICKNESS_M / 2,
        x=(left + right) / 2,
        y=(top + bottom) / 2,
    )


def _reach(board: BoardPrint, cam_from_board: SE3) -> Float[Array, "views"]:
    """Distance of the farthest corner of the print [m]."""
    left, top, right, bottom = board.box_m
    outline = np.array([[x, y, 0] for x in (left, right) for y in (top, bottom)])
    return np.linalg.norm(cam_from_board.apply(outline), axis=-1).max(axis=-1, initial=0.0)
