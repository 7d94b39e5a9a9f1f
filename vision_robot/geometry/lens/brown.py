"""Brown's lens: radial and tangential distortion of the pinhole plane.

Brown (1971), in OpenCV's order of coefficients: k1, k2, p1, p2, k3 and, for the
rational form (Claus & Fitzgibbon 2005), k4, k5, k6 in the denominator.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from vision_robot.geometry.lens.lens import Lens, first_positive_root
from vision_robot.types import Array

__all__ = ["BROWN5", "BROWN8"]

WIDEST = 57.0
"""tan 89 degrees: the pinhole plane has no room for more."""


def _padded(k: Sequence[float]) -> tuple[float, ...]:
    return (*k, *(0.0,) * (8 - len(k)))


def plane_field(points: Array) -> Array:
    """Tangent of the angle from the axis, infinite behind the camera."""
    x, y, z = points
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(z > 0, np.hypot(x, y) / z, np.inf)


def plane_ray(s: Array, towards: Array) -> Array:
    """Points on the plane z = 1 at radius s."""
    return np.stack([s * towards[0], s * towards[1], np.ones_like(s)])


def _distort(points: Array, k: Sequence[float]) -> Array:
    k1, k2, p1, p2, k3, k4, k5, k6 = _padded(k)
    x, y = points[0] / points[2], points[1] / points[2]
    r2 = x * x + y * y
    g = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    if len(k) > 5:
        g = g / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)))
    xy2 = 2 * x * y
    return np.stack([x * g + p1 * xy2 + p2 * (r2 + 2 * x * x), y * g + p2 * xy2 + p1 * (r2 + 2 * y * y)])


def _jacobian(points: Array, k: Sequence[float]) -> tuple[Array, Array]:
    k1, k2, p1, p2, k3, k4, k5, k6 = _padded(k)
    rational = len(k) > 5
    inverse_z = 1 / points[2]
    x, y = points[0] * inverse_z, points[1] * inverse_z
    x2, y2, xy2 = x * x, y * y, 2 * x * y
    r2 = x2 + y2
    r4 = r2 * r2
    r6 = r4 * r2
    numerator = 1 + k1 * r2 + k2 * r4 + k3 * r6
    slope = k1 + 2 * k2 * r2 + 3 * k3 * r4
    if rational:
        inverse = 1 / (1 + k4 * r2 + k5 * r4 + k6 * r6)
        g = numerator * inverse
        slope = (slope - g * (k4 + 2 * k5 * r2 + 3 * k6 * r4)) * inverse
    else:
        inverse = 1.0
        g = numerator
    # d(distorted)/d(x, y); `slope` is dg/d(r2).
    diagonal = 2 * slope
    xx = g + diagonal * x2 + 2 * p1 * y + 6 * p2 * x
    yy = g + diagonal * y2 + 2 * p2 * x + 6 * p1 * y
    cross = slope * xy2 + 2 * p1 * x + 2 * p2 * y

    out = np.empty((2, 3 + len(k), x.shape[0]))
    out[0, 0], out[0, 1] = xx * inverse_z, cross * inverse_z
    out[1, 0], out[1, 1] = out[0, 1], yy * inverse_z
    out[0, 2] = -(x * out[0, 0] + y * out[0, 1])
    out[1, 2] = -(x * out[1, 0] + y * out[1, 1])
    xi, yi = x * inverse, y * inverse
    out[0, 3], out[1, 3] = xi * r2, yi * r2
    out[0, 4], out[1, 4] = xi * r4, yi * r4
    out[0, 5], out[1, 5] = xy2, r2 + 2 * y2
    out[0, 6], out[1, 6] = r2 + 2 * x2, xy2
    out[0, 7], out[1, 7] = xi * r6, yi * r6
    if rational:
        out[:, 8], out[:, 9], out[:, 10] = -g * out[:, 3], -g * out[:, 4], -g * out[:, 7]
    distorted = np.stack([x * g + p1 * out[0, 5] + p2 * out[0, 6], y * g + p1 * out[1, 5] + p2 * out[1, 6]])
    return distorted, out


def _radial(s: Array, k: Sequence[float]) -> tuple[Array, Array]:
    k1, k2, _, _, k3, k4, k5, k6 = _padded(k)
    r2 = s * s
    over = 1 + r2 * (k4 + r2 * (k5 + r2 * k6))
    g = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / over
    slope = (k1 + r2 * (2 * k2 + 3 * k3 * r2) - g * (k4 + r2 * (2 * k5 + 3 * k6 * r2))) / over
    return s * g, g + 2 * r2 * slope


@lru_cache(maxsize=256)
def _fold(k: tuple[float, ...]) -> float:
    """First s where d(radial)/ds = 0 or the denominator vanishes."""
    k1, k2, _, _, k3, k4, k5, k6 = _padded(k)
    top = np.polynomial.Polynomial([1, k1, k2, k3])
    bottom = np.polynomial.Polynomial([1, k4, k5, k6])
    t = np.polynomial.Polynomial([0, 1])
    # With t = s^2: d/ds [s n(t)/d(t)] = (n d + 2 t (n' d - n d')) / d^2.
    turning = top * bottom + 2 * t * (top.deriv() * bottom - top * bottom.deriv())
    widest = WIDEST**2
    pole = (1 - 1e-9) * first_positive_root(list(bottom.coef), 2 * widest)
    return float(np.sqrt(min(first_positive_root(list(turning.coef), widest), pole)))


BROWN5 = Lens(
    name="brown5",
    coefficient_names=("k1", "k2", "p1", "p2", "k3"),
    distort=_distort,
    jacobian=_jacobian,
    radial=_radial,
    fold=_fold,
    field=plane_field,
    ray=plane_ray,
    tangential=True,
)

BROWN8 = Lens(
    name="brown8",
    coefficient_names=("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
    distort=_distort,
    jacobian=_jacobian,
    radial=_radial,
    fold=_fold,
    field=plane_field,
    ray=plane_ray,
    tangential=True,
)
