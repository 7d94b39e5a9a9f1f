"""The lens without distortion: the pinhole."""

from collections.abc import Sequence

import numpy as np

from vision_robot.geometry.lens.brown import WIDEST, plane_field, plane_ray
from vision_robot.geometry.lens.lens import Lens
from vision_robot.types import Array

__all__ = ["PINHOLE"]


def _distort(points: Array, _k: Sequence[float]) -> Array:
    return points[:2] / points[2]


def _jacobian(points: Array, _k: Sequence[float]) -> tuple[Array, Array]:
    inverse_z = 1 / points[2]
    distorted = points[:2] * inverse_z
    out = np.zeros((2, 3, points.shape[1]))
    out[0, 0] = out[1, 1] = inverse_z
    out[:, 2] = -distorted * inverse_z
    return distorted, out


def _radial(s: Array, _k: Sequence[float]) -> tuple[Array, Array]:
    return s, np.ones_like(s)


PINHOLE = Lens(
    name="pinhole",
    coefficient_names=(),
    distort=_distort,
    jacobian=_jacobian,
    radial=_radial,
    fold=lambda _k: WIDEST,
    field=plane_field,
    ray=plane_ray,
)
