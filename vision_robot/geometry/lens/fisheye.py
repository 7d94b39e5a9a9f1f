"""The fisheye lens of Kannala & Brandt (2006), as OpenCV's and Kalibr's four coefficients.

radius = theta + k1 theta^3 + k2 theta^5 + k3 theta^7 + k4 theta^9, with theta the angle
between the ray and the optical axis; rays behind the image plane are welcome.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from vision_robot.geometry.lens.lens import Lens, first_positive_root
from vision_robot.types import Array

__all__ = ["FISHEYE"]


def _angle(points: Array) -> Array:
    x, y, z = points
    return np.arctan2(np.hypot(x, y), z)


def _distort(points: Array, k: Sequence[float]) -> Array:
    rho = np.hypot(points[0], points[1])
    radius = _radial(np.arctan2(rho, points[2]), k)[0]
    on_axis = rho < 1e-12 * np.abs(points[2])
    scale = np.where(on_axis, 1 / points[2], radius / np.where(on_axis, 1.0, rho))
    return points[:2] * scale


def _jacobian(points: Array, k: Sequence[float]) -> tuple[Array, Array]:
    x, y, z = points
    rho = np.hypot(x, y)
    on_axis = rho < 1e-12 * np.abs(z)
    safe = np.where(on_axis, 1.0, rho)
    theta = np.arctan2(rho, z)
    radius, slope = _radial(theta, k)
    cos, sin = np.where(on_axis, 1.0, x / safe), np.where(on_axis, 0.0, y / safe)
    scale = np.where(on_axis, 1 / z, radius / safe)
    range2 = rho * rho + z * z
    along = slope * z / range2  # d(radius)/d(rho)
    down = -slope * rho / range2  # d(radius)/dz

    out = np.empty((2, 3 + len(k), points.shape[1]))
    out[0, 0] = along * cos * cos + scale * sin * sin
    out[1, 1] = along * sin * sin + scale * cos * cos
    out[0, 1] = out[1, 0] = (along - scale) * cos * sin
    out[0, 2], out[1, 2] = down * cos, down * sin
    power = theta
    for i in range(len(k)):
        power = power * theta * theta
        out[0, 3 + i], out[1, 3 + i] = power * cos, power * sin
    return np.stack([x * scale, y * scale]), out


def _radial(s: Array, k: Sequence[float]) -> tuple[Array, Array]:
    k1, k2, k3, k4 = k
    s2 = s * s
    value = s * (1 + s2 * (k1 + s2 * (k2 + s2 * (k3 + s2 * k4))))
    slope = 1 + s2 * (3 * k1 + s2 * (5 * k2 + s2 * (7 * k3 + s2 * 9 * k4)))
    return value, slope


@lru_cache(maxsize=256)
def _fold(k: tuple[float, ...]) -> float:
    k1, k2, k3, k4 = k
    # Just short of straight backwards, where the direction of a ray is lost.
    return float(np.sqrt(first_positive_root([1, 3 * k1, 5 * k2, 7 * k3, 9 * k4], (np.pi - 1e-6) ** 2)))


def _ray(s: Array, towards: Array) -> Array:
    return np.stack([np.sin(s) * towards[0], np.sin(s) * towards[1], np.cos(s)])


FISHEYE = Lens(
    name="fisheye",
    coefficient_names=("k1", "k2", "k3", "k4"),
    distort=_distort,
    jacobian=_jacobian,
    radial=_radial,
    fold=_fold,
    field=_angle,
    ray=_ray,
)
