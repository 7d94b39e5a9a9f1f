"""A cell as one MuJoCo model, put together with MjSpec."""

from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

import vision_robot.arm
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3
from vision_robot.sim.cell_design import ArmMount, Belt, CellDesign, Colour, Item, Lights, Table
from vision_robot.sim.gl import load_mujoco
from vision_robot.sim.shapes import Collider, Shape, shape_named
from vision_robot.sim.surfaces import BELT_PITCH_M, belt_picture, table_picture
from vision_robot.types import Array, Float, UInt8

__all__ = [
    "ARM",
    "BACKGROUND",
    "BELT",
    "ITEM",
    "LABEL",
    "LABEL_THICKNESS_M",
    "FIXED",
    "FLOOR_BELOW_M",
    "MOVING",
    "build",
    "quaternion",
    "resting",
]

MjSpec: TypeAlias = Any
MjsBody: TypeAlias = Any
MjModel: TypeAlias = Any
Picture: TypeAlias = UInt8[Array, "rows columns 3"]

OWN_ARM = Path(vision_robot.arm.__file__).parent / "models" / "column_arm.xml"

BACKGROUND, MOVING, FIXED, COLLIDERS = 0, 1, 2, 3
"""Groups of geoms: table, belt and floor; what can move; what stands; what collides and is not drawn."""
ITEM, ARM = "item/", "arm/"
"""Beginnings of names."""
TABLE, BELT, LABEL = "table", "belt", "label"
BACKGROUNDS = (TABLE, TABLE + "1", "belt_seen", "floor")

TABLE_THICKNESS_M = 0.03
LABEL_THICKNESS_M = 0.002
FLOOR_BELOW_M = 0.75

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
        _add_arm(mj, spec, design.arm)
    station = spec.worldbody.add_body(name="station")
    _put(station, design.base_from_station)
    station.add_site(name="station", size=[0.005] * 3, rgba=[0, 0, 0, 0])
    _add_table(mj, spec, station, design.table, design.belt)
    if design.belt is not None:
        _add_belt(mj, spec, station, design.table, design.belt, design.base_from_station)
    _add_lights(mj, spec, design.lights, design.base_from_station)
    for item in design.items:
        _add_item(mj, spec, item, design.base_from_station)
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


def quaternion(rotation: Float[Array, "3 3"]) -> Float[Array, "4"]:
    """MuJoCo's quaternion (w, x, y, z) of a rotation matrix."""
    result = np.zeros(4)
    load_mujoco(rendering=False).mju_mat2Quat(result, np.ascontiguousarray(rotation).ravel())
    return result


def resting(item: Item, place: Float[Array, "4"]) -> SE3:
    """station_from_item where the item lies at (x, y, height above rest, yaw)."""
    x, y, above, yaw = (float(value) for value in place)
    rest = shape_named(item.shape, item.size_m, item.colour).rest_m
    return SE3.from_rotvec(np.array([0, 0, yaw]), np.array([x, y, rest + above]))


def _put(body: MjsBody, pose: SE3) -> None:
    body.pos, body.quat = pose.translation, quaternion(pose.rotation)


def _add_picture(mj: Any, spec: MjSpec, name: str, picture: Picture) -> None:
    """Room for a picture; `_paint` brings it there once the model is compiled."""
    rows, columns = picture.shape[:2]
    texture = spec.add_texture(name=name, type=mj.mjtTexture.mjTEXTURE_2D, width=columns, height=rows)
    texture.builtin = mj.mjtBuiltin.mjBUILTIN_FLAT


def _paint(model: MjModel, name: str, picture: Picture) -> None:
    texture = model.texture(name)
    first = int(texture.adr[0])
    model.tex_data[first : first + picture.size] = picture.ravel()


def _add_table(mj: Any, spec: MjSpec, station: MjsBody, table: Table, belt: Belt | None) -> None:
    """The top as one box, or as two with the belt between; below it a floor.

    They cast no shadow themselves: a shadow map speckles large faces with their own.
    """
    material = spec.add_material(name=TABLE, specular=0.08, shininess=0.2)
    material.textures[mj.mjtTextureRole.mjTEXROLE_RGB] = TABLE
    (width, depth), (x, y) = table.size_m, table.middle_m
    spans = [(x - width / 2, x + width / 2)]
    if belt is not None:
        near, far = belt.x_m - belt.width_m / 2, belt.x_m + belt.width_m / 2
        if not spans[0][0] < near < far < spans[0][1]:
            raise BadParameter(
                "belt", (near, far), f"inside the table, x from {spans[0][0]:g} to {spans[0][1]:g} m"
            )
        spans = [(spans[0][0], near), (far, spans[0][1])]
    for i, (low, high) in enumerate(spans):
        station.add_geom(
            name=f"table{i}" if i else "table",
            type=mj.mjtGeom.mjGEOM_BOX,
            size=[(high - low) / 2, depth / 2, TABLE_THICKNESS_M / 2],
            pos=[(low + high) / 2, y, -TABLE_THICKNESS_M / 2],
            material=TABLE,
            group=BACKGROUND,
            friction=TABLE_FRICTION,
            castshadow=False,
        )
    station.add_geom(
        name="floor",
        type=mj.mjtGeom.mjGEOM_BOX,
        size=[2.5, 2.5, 0.01],
        pos=[0, 0, -FLOOR_BELOW_M],
        rgba=[0.36, 0.37, 0.39, 1],
        group=BACKGROUND,
        friction=TABLE_FRICTION,
        castshadow=False,
    )


TABLE_FRICTION = [0.5, 0.003, 0.0002]
"""Sliding, torsional [m], rolling [m]."""


def _add_belt(
    mj: Any, spec: MjSpec, station: MjsBody, table: Table, belt: Belt, base_from_station: SE3
) -> None:
    """What carries is a still geom whose surface moves; what is seen moves, and jumps back by pitches."""
    half = [belt.width_m / 2, table.size_m[1] / 2, TABLE_THICKNESS_M / 2]
    middle = np.array([belt.x_m, table.middle_m[1], -TABLE_THICKNESS_M / 2])
    station.add_geom(
        name=BELT,
        type=mj.mjtGeom.mjGEOM_BOX,
        size=half,
        pos=middle,
        group=COLLIDERS,
        friction=[0.8, *TABLE_FRICTION[1:]],
        surfacevel=[0, belt.speed_m_s, 0, 0, 0, 0],
    )
    pitches = np.ceil(table.size_m[1] / BELT_PITCH_M) + 2
    material = spec.add_material(name=BELT, specular=0.05, shininess=0.1, texrepeat=[1, pitches])
    material.textures[mj.mjtTextureRole.mjTEXROLE_RGB] = BELT
    moving = spec.worldbody.add_body(name=BELT, mocap=True)
    _put(moving, base_from_station @ SE3(np.eye(3), middle))
    moving.add_geom(
        name="belt_seen",
        type=mj.mjtGeom.mjGEOM_BOX,
        size=[half[0], pitches * BELT_PITCH_M / 2, half[2]],
        material=BELT,
        group=BACKGROUND,
        contype=0,
        conaffinity=0,
        castshadow=False,
    )


SKY_SHARE = 0.25
"""Share of the ambient light that comes from straight above, so that sides are darker than tops."""


def _add_lights(mj: Any, spec: MjSpec, lights: Lights, base_from_station: SE3) -> None:
    """The key light, and light from everywhere: an ambient share of a second one from straight above."""
    towards = base_from_station.rotation @ direction(lights.azimuth_rad, lights.elevation_rad)
    spec.worldbody.add_light(
        name="key",
        type=mj.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=base_from_station.translation + 1.6 * towards,
        dir=-towards,
        diffuse=[lights.key] * 3,
        ambient=[0, 0, 0],
        specular=[0.5 * lights.key] * 3,
        castshadow=lights.shadows,
    )
    up = base_from_station.rotation[:, 2]
    spec.worldbody.add_light(
        name="sky",
        type=mj.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=base_from_station.translation + 2 * up,
        dir=-up,
        diffuse=[SKY_SHARE * lights.ambient] * 3,
        ambient=[(1 - SKY_SHARE) * lights.ambient] * 3,
        specular=[0, 0, 0],
        castshadow=False,
    )


def direction(azimuth_rad: float, elevation_rad: float) -> Float[Array, "3"]:
    """Unit vector towards a light."""
    flat = np.cos(elevation_rad)
    return np.array([flat * np.cos(azimuth_rad), flat * np.sin(azimuth_rad), np.sin(elevation_rad)])


def _add_item(mj: Any, spec: MjSpec, item: Item, base_from_station: SE3) -> None:
    """A body with a drawn mesh for each part, and invisible colliders that carry the mass."""
    shape = shape_named(item.shape, item.size_m, item.colour)
    body = spec.worldbody.add_body(name=ITEM + item.name, mocap=item.path is not None)
    start = np.array([item.x_m, item.y_m, item.above_m, item.yaw_rad])
    _put(body, base_from_station @ resting(item, start if item.path is None else item.path.at(0.0)))
    if item.path is None and not item.fixed:
        body.add_freejoint(name=ITEM + item.name)
    for k, part in enumerate(shape.parts):
        name = f"{ITEM}{item.name}/{k}"
        spec.add_mesh(name=name, uservert=part.corners.ravel())
        spec.add_material(name=name, rgba=[*part.colour, 1], specular=item.glossy, shininess=0.5)
        body.add_geom(
            name=name,
            type=mj.mjtGeom.mjGEOM_MESH,
            meshname=name,
            material=name,
            group=MOVING,
            contype=0,
            conaffinity=0,
            mass=0,
        )
    for collider in shape.colliders:
        _add_collider(mj, spec, body, item, shape, collider)


def _add_collider(mj: Any, spec: MjSpec, body: MjsBody, item: Item, shape: Shape, collider: Collider) -> None:
    name = f"{ITEM}{item.name}/solid"
    kinds = {
        "box": mj.mjtGeom.mjGEOM_BOX,
        "capsule": mj.mjtGeom.mjGEOM_CAPSULE,
        "mesh": mj.mjtGeom.mjGEOM_MESH,
    }
    if collider.kind == "mesh":
        spec.add_mesh(name=name, uservert=shape.hull.ravel())
    geom = body.add_geom(
        name=name,
        type=kinds[collider.kind],
        meshname=name if collider.kind == "mesh" else "",
        pos=collider.middle,
        quat=[np.sqrt(0.5), 0, np.sqrt(0.5), 0] if collider.along_x else [1, 0, 0, 0],
        group=COLLIDERS,
        density=shape.density,
        condim=6,
        friction=[0.5, 0.003, 0.0002],
        solref=[0.005, 1],
        solimp=[0.95, 0.99, 0.0005, 0.5, 2],
    )
    if collider.size:
        geom.size[: len(collider.size)] = collider.size


def _add_arm(mj: Any, spec: MjSpec, mount: ArmMount) -> None:
    """Attach the arm's bodies and what goes with them; hang the label on what carries the tool."""
    path = Path(mount.mjcf or OWN_ARM)
    try:
        arm = mj.MjSpec.from_file(str(path))
    except (OSError, ValueError) as error:
        raise BadParameter("arm", str(path), f"an MJCF file that MuJoCo can read ({error})") from error
    tool = arm.site("tool")
    if tool is None:
        raise BadParameter("arm", str(path), 'an MJCF file with a site "tool" between the fingers')
    if mount.label is not None:
        _add_label(mj, arm, tool.parent, mount, mount.label)
    spec.attach(arm, frame=spec.worldbody.add_frame(), prefix=ARM)


def _add_label(mj: Any, arm: MjSpec, hand: MjsBody, mount: ArmMount, colour: Colour) -> None:
    """A coloured plate on a bracket, facing away from where the tool points."""
    site = arm.site("label")
    if site is None:
        raise BadParameter("arm", str(mount.mjcf), 'an MJCF file with a site "label" to hang the label on')
    half = [mount.label_m[0] / 2, mount.label_m[1] / 2, LABEL_THICKNESS_M / 2]
    plate = hand.add_body(name=LABEL, pos=site.pos, quat=site.quat, gravcomp=1)
    if site.alt.type != mj.mjtOrientation.mjORIENTATION_QUAT:
        plate.alt = site.alt
    plate.add_geom(
        name=LABEL,
        type=mj.mjtGeom.mjGEOM_BOX,
        size=half,
        rgba=[*colour, 1],
        mass=0.004,
        contype=0,
        conaffinity=0,
        group=MOVING,
    )
