"""A cell as one MuJoCo model, put together with MjSpec."""

from typing import Any, TypeAlias

import numpy as np

from vision_robot.sim.cell_design import CellDesign
from vision_robot.sim.cell_names import (
    ARM,
    BACKGROUND,
    BACKGROUNDS,
    BELT,
    COLLIDERS,
    FIXED,
    ITEM,
    LABEL,
    MOVING,
    TABLE,
)
from vision_robot.sim.gl import load_mujoco
from vision_robot.sim.inhabitants import add_arm, add_item
from vision_robot.sim.placing import put, quaternion, resting
from vision_robot.sim.surfaces import belt_picture, table_picture
from vision_robot.sim.surroundings import add_belt, add_lights, add_table
from vision_robot.types import Array, UInt8

__all__ = [
    "ARM",
    "BACKGROUND",
    "BELT",
    "COLLIDERS",
    "FIXED",
    "ITEM",
    "LABEL",
    "MOVING",
    "build",
    "quaternion",
    "resting",
]

MjSpec: TypeAlias = Any
MjModel: TypeAlias = Any
Picture: TypeAlias = UInt8[Array, "rows columns 3"]

# Newton with the dense Hessian: the sparse one of MuJoCo 4.0.0 is wrong. Elliptic cones and impratio
# keep what is grasped from creeping out of the fingers.
SCENE = """
<mujoco model="cell">
  <compiler angle="radian" autolimits="true"/>
  <option jacobian="dense" solver="Newton" integrator="implicitfast" cone="elliptic" impratio="20"
          timestep="{timestep:.9g}"/>
  <statistic extent="1" center="{x:.9g} {y:.9g} {z:.9g}" meansize="0.05"/>
  <visual>
    <map znear="0.05" zfar="8" shadowclip="0.6" shadowscale="0.9"/>
    <quality shadowsize="{shadow_px}" numslices="40" numstacks="16" numquads="4"/>
    <headlight ambient="0 0 0" diffuse="0 0 0" specular="0 0 0"/>
  </visual>
  <asset>
    <texture name="sky" type="skybox" builtin="gradient" width="64" height="64"
             rgb1="0.72 0.74 0.77" rgb2="0.42 0.43 0.45"/>
  </asset>
</mujoco>
"""


def build(design: CellDesign) -> MjModel:
    """The compiled model: world is {B}; site "station" is {S}; items are bodies "item/<name>"."""
    mj = load_mujoco(rendering=False)
    x, y, z = design.base_from_station.translation
    text = SCENE.format(timestep=design.timestep_s, x=x, y=y, z=z, shadow_px=design.lights.shadow_px)
    spec = mj.MjSpec.from_string(text)
    if design.arm is not None:
        add_arm(mj, spec, design.arm)
    station = spec.worldbody.add_body(name="station")
    put(station, design.base_from_station)
    station.add_site(name="station", size=[0.005] * 3, rgba=[0, 0, 0, 0])
    add_table(mj, spec, station, design.table, design.belt)
    if design.belt is not None:
        add_belt(mj, spec, station, design.table, design.belt, design.base_from_station)
    add_lights(mj, spec, design.lights, design.base_from_station)
    for item in design.items:
        add_item(mj, spec, item, design.base_from_station)
    pictures = {TABLE: table_picture(design.table.surface, design.table.colour, design.table.seed)}
    if design.belt is not None:
        pictures[BELT] = belt_picture(design.belt.colour)
    for name, picture in pictures.items():
        _add_picture(mj, spec, name, picture)
    model = spec.compile()
    _sort_into_groups(model)
    for name, picture in pictures.items():
        _paint(model, name, picture)
    return model


def _sort_into_groups(model: MjModel) -> None:
    """What is drawn and is not background goes by whether it can move, however a file has it."""
    bodies = model.geom_bodyid
    mocap = model.body_mocapid[model.body_rootid[bodies]] >= 0
    moves = (model.body_weldid[bodies] != 0) | mocap
    names = [model.geom(i).name for i in range(model.ngeom)]
    background = np.array([name in BACKGROUNDS for name in names])
    drawn = (model.geom_group < COLLIDERS) & ~background
    model.geom_group[drawn] = np.where(moves, MOVING, FIXED)[drawn]


def _add_picture(mj: Any, spec: MjSpec, name: str, picture: Picture) -> None:
    """Room for a picture; `_paint` brings it there once the model is compiled."""
    rows, columns = picture.shape[:2]
    texture = spec.add_texture(name=name, type=mj.mjtTexture.mjTEXTURE_2D, width=columns, height=rows)
    texture.builtin = mj.mjtBuiltin.mjBUILTIN_FLAT


def _paint(model: MjModel, name: str, picture: Picture) -> None:
    texture = model.texture(name)
    first = int(texture.adr[0])
    model.tex_data[first : first + picture.size] = picture.ravel()
