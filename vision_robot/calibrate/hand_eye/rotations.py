"""Rotations as robots write them, into matrices: quaternions, Euler angles, rotation vectors, matrices."""

import re

import numpy as np

from vision_robot.calibrate.hand_eye.closed_forms.translation import nearest_rotation
from vision_robot.errors import BadParameter
from vision_robot.geometry import rotation_exp
from vision_robot.types import Array, Float

__all__ = ["ANGLES", "EULER_ORDERS", "from_euler", "from_matrix", "from_quaternion", "is_euler_order"]

ANGLES = ("rotvec", "euler")
"""Kinds of rotation whose numbers are angles."""

EULER_ORDERS = ("xyz", "zyx", "ZYX", "XYZ", "ZYZ", "zyz", "ZXZ", "YXZ", "yxz", "ZXY", "XZY", "YZX")
"""Orders in use, lower case about fixed axes, upper case about the turning ones; first what robots favour."""

QUATERNION_SLACK = 0.02
MATRIX_SLACK = 0.02
"""How far rounded numbers may be from a rotation."""


def from_quaternion(
    values: Float[Array, "n 4"], order: str
) -> tuple[Float[Array, "n 3 3"], Float[Array, "n"]]:
    """Rotations of quaternions, their numbers in that `order`, and how far each length is from one."""
    if sorted(order) != sorted("wxyz"):
        raise BadParameter("quaternion order", order, "wxyz or xyzw")
    q = np.asarray(values)[:, [order.index(letter) for letter in "wxyz"]]
    length = np.linalg.norm(q, axis=1)
    w, x, y, z = (q / np.maximum(length, 1e-12)[:, None]).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2), np.abs(length - 1)


def from_matrix(values: Float[Array, "n 3 3"]) -> tuple[Float[Array, "n 3 3"], Float[Array, "n"]]:
    """The nearest rotations, and how far each matrix is from its own; infinite for a mirror."""
    nearest = nearest_rotation(values)
    off = np.abs(values - nearest).max(axis=(1, 2))
    return nearest, np.where(np.linalg.det(values) > 0, off, np.inf)


def is_euler_order(order: str) -> bool:
    """Three axes, neighbours different, in one case."""
    return bool(re.fullmatch(r"[xyz]{3}|[XYZ]{3}", order)) and order[0] != order[1] != order[2]


def from_euler(angles: Float[Array, "n 3"], order: str) -> Float[Array, "n 3 3"]:
    """Rotations of three angles [rad] in the order in which the axes are named.

    Lower case: about the axes that stand still, each turn multiplied from the left; upper case: about
    the axes as turned so far, from the right. So "xyz" of (roll, pitch, yaw) is "ZYX" of (yaw, pitch, roll).
    """
    if not is_euler_order(order):
        raise BadParameter("order of Euler angles", order, "three axes such as xyz (fixed) or ZYX (turning)")
    total = np.broadcast_to(np.eye(3), (len(angles), 3, 3))
    for i, axis in enumerate(order):
        unit = np.eye(3)["xyz".index(axis.lower())]
        turn = rotation_exp(angles[:, i, None] * unit)
        total = total @ turn if axis.isupper() else turn @ total
    return total
