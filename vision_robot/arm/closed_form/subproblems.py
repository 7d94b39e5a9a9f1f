"""The small problems that closed forms are made of, in CasADi symbols.

They are Paden and Kahan's (Murray, Li & Sastry 1994, section 3.2) in forms that keep all digits at
the border of what can be reached, and that give the nearest answer past it instead of no number: it then
serves as a start, and its error is measured by whoever uses it.
"""

from typing import Any

import numpy as np

__all__ = ["angle_between", "constant", "place_two_links", "project", "turned", "turns_to_component"]

Vector = Any
"""Three numbers, numpy's or CasADi's."""


def constant(values: Any) -> Any:
    """Numbers as symbols, rounding dust swept away: zeros cost no operation."""
    import casadi as ca

    values = np.asarray(values, dtype=float)
    near = np.round(values)
    return ca.SX(ca.DM(np.where(np.abs(values - near) < 1e-14, near, values)))


def turned(axis: Vector, angle: Any, vector: Vector) -> Vector:
    """Rot(axis, angle) vector (Rodrigues)."""
    import casadi as ca

    along = axis * ca.dot(axis, vector)
    return along + ca.cos(angle) * (vector - along) + ca.sin(angle) * ca.cross(axis, vector)


def project(axis: Vector, vector: Vector) -> Vector:
    """The part of a vector at right angles to a unit axis."""
    import casadi as ca

    return vector - axis * ca.dot(axis, vector)


def angle_between(axis: Vector, start: Vector, end: Vector) -> Any:
    """Angle about `axis` that takes `start` to `end`, both seen along the axis; in (-pi, pi]."""
    import casadi as ca

    start, end = project(axis, start), project(axis, end)
    return ca.atan2(ca.dot(axis, ca.cross(start, end)), ca.dot(start, end))


def turns_to_component(cosine: Any, sine: Any, value: Any) -> tuple[Any, Any]:
    """Both angles t with ``cosine cos t + sine sin t = value``; the nearest where there is none."""
    import casadi as ca

    length = ca.sqrt(cosine * cosine + sine * sine)
    middle = ca.atan2(sine, cosine)
    half = ca.atan2(ca.sqrt(ca.fmax((length - value) * (length + value), 0)), value)
    return middle + half, middle - half


def place_two_links(axis: Vector, first: Vector, second: Vector, end: Vector) -> list[tuple[Any, Any]]:
    """Angles (s, t) with ``Rot(axis, s) (first + Rot(axis, t) second) = end`` at right angles to the axis.

    Both bends of the elbow.
    """
    import casadi as ca

    first, second, end = project(axis, first), project(axis, second), project(axis, end)
    value = ca.dot(end, end) - ca.dot(first, first) - ca.dot(second, second)
    bends = turns_to_component(2 * ca.dot(first, second), 2 * ca.dot(first, ca.cross(axis, second)), value)
    return [(angle_between(axis, first + turned(axis, bend, second), end), bend) for bend in bends]
