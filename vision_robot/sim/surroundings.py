"""What stands around the things of a cell: table, floor, belt and lights."""

from typing import Any, TypeAlias

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3
from vision_robot.sim.cell_design import Belt, Lights, Table
from vision_robot.sim.cell_names import BACKGROUND, BELT, COLLIDERS, FLOOR_BELOW_M, TABLE, TABLE_THICKNESS_M
from vision_robot.sim.placing import put
from vision_robot.sim.surfaces import BELT_PITCH_M
from vision_robot.types import Array, Float

__all__ = ["SKY_SHARE", "add_belt", "add_lights", "add_table", "direction"]

MjSpec: TypeAlias = Any
MjsBody: TypeAlias = Any


def add_table(mj: Any, spec: MjSpec, station: MjsBody, table: Table, belt: Belt | None) -> None:
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


def add_belt(
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
    put(moving, base_from_station @ SE3(np.eye(3), middle))
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


def add_lights(mj: Any, spec: MjSpec, lights: Lights, base_from_station: SE3) -> None:
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
