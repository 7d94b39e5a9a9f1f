"""Poses as MuJoCo has them, and where an item lies."""

from typing import Any, TypeAlias

import numpy as np

from vision_robot.geometry import SE3
from vision_robot.sim.cell_design import Item
from vision_robot.sim.gl import load_mujoco
from vision_robot.sim.shapes import shape_named
from vision_robot.types import Array, Float

__all__ = ["put", "quaternion", "resting"]

MjsBody: TypeAlias = Any


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


def put(body: MjsBody, pose: SE3) -> None:
    """Put a body of a model under construction there."""
    body.pos, body.quat = pose.translation, quaternion(pose.rotation)
