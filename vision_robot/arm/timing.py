"""When an arm may be where on its path: as fast as joint velocities and accelerations allow."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float

__all__ = ["Trajectory", "timed"]

GRID = 401
"""Points of the path at which limits are looked at."""

ROUNDS = 5
"""Times that what passes a limit between the points is slowed; what is left then slows the whole."""


@dataclass(frozen=True)
class Trajectory:
    """Joint values, velocities and accelerations at times, from rest to rest."""

    joint_names: tuple[str, ...]
    time_s: Float[Array, "points"]
    q: Float[Array, "points n"]
    velocity: Float[Array, "points n"]
    acceleration: Float[Array, "points n"]

    @property
    def seconds(self) -> float:
        """How long it takes."""
        return float(self.time_s[-1])

    def at(self, time_s: Float[Array, "k"]) -> Float[Array, "k n"]:
        """Joint values at any times: cubic between the points, by values and velocities."""
        from scipy.interpolate import CubicHermiteSpline

        return CubicHermiteSpline(self.time_s, self.q, self.velocity)(np.clip(time_s, 0, self.seconds))


def timed(
    joint_names: tuple[str, ...],
    q: Float[Array, "points n"],
    *,
    velocity: Float[Array, "n"],
    acceleration: Float[Array, "n"],
) -> Trajectory:
    """The fastest motion along joint values, from rest to rest, within each joint's limits [SI].

    Reachability analysis of the path's speed (Pham & Pham 2018, IEEE T-RO 34(3)): backwards for the
    greatest speeds from which the end can still be braked for, then forwards as fast as they allow.
    """
    velocity, acceleration = np.asarray(velocity, dtype=float), np.asarray(acceleration, dtype=float)
    for name, limit in (("velocity", velocity), ("acceleration", acceleration)):
        if limit.shape != q.shape[1:] or not (np.isfinite(limit) & (limit > 0)).all():
            raise BadParameter(f"{name} limits", limit.tolist(), f"{q.shape[1]} positive numbers")
    s, path, first, second = _smooth(q)
    if s is None:
        still = np.zeros((1, q.shape[1]))
        return Trajectory(joint_names, np.zeros(1), q[:1], still, still)
    step = float(s[1] - s[0])
    fastest = _square_limits(first, velocity)
    room = np.ones(len(s))
    motion = _fastest(joint_names, step, (path, first, second), fastest, acceleration * room[:, None])
    fast, hard = _overshoot(motion, velocity, acceleration)
    for _ in range(ROUNDS):
        # Speeds that hold at the points may still be too much between them: there less is allowed.
        fastest, room = fastest / _both_ends(fast) ** 2, room / _both_ends(hard)
        motion = _fastest(joint_names, step, (path, first, second), fastest, acceleration * room[:, None])
        fast, hard = _overshoot(motion, velocity, acceleration)
    slower = max(1.0, float(fast.max()), float(np.sqrt(hard.max())))
    return Trajectory(
        joint_names,
        motion.time_s * slower,
        motion.q,
        motion.velocity / slower,
        motion.acceleration / slower**2,
    )


def _fastest(
    joint_names: tuple[str, ...],
    step: float,
    curve: tuple[Array, Array, Array],
    fastest: Float[Array, "grid"],
    acceleration: Float[Array, "grid n"],
) -> Trajectory:
    """Along a curve (values, first and second derivative), with limits at the points of the grid."""
    path, first, second = curve
    count = len(path)
    braking = np.zeros(count)
    for k in range(count - 2, -1, -1):
        braking[k] = _most(first[k], second[k], acceleration[k], fastest[k], braking[k + 1], step)
    square, push = np.zeros(count), np.zeros(count)
    for k in range(count - 1):
        _, high = _pushes(first[k], second[k], acceleration[k], square[k])
        push[k] = min(high, (braking[k + 1] - square[k]) / (2 * step))
        square[k + 1] = max(square[k] + 2 * step * push[k], 0.0)
    push[-1] = push[-2]
    speed = np.sqrt(square)
    times = np.concatenate([[0.0], np.cumsum(2 * step / np.maximum(speed[1:] + speed[:-1], 1e-12))])
    pushes = first * push[:, None] + second * square[:, None]
    return Trajectory(joint_names, times, path, first * speed[:, None], pushes)


def _overshoot(
    motion: Trajectory, velocity: Float[Array, "n"], acceleration: Float[Array, "n"]
) -> tuple[Float[Array, "cells"], Float[Array, "cells"]]:
    """By what factor, one or more, velocity and acceleration pass their limits between points of the grid."""
    from scipy.interpolate import CubicHermiteSpline

    curve = CubicHermiteSpline(motion.time_s, motion.q, motion.velocity)
    inside = motion.time_s[:-1, None] + np.diff(motion.time_s)[:, None] * np.array([1e-6, 0.5, 1 - 1e-6])
    fast = (np.abs(curve(inside, 1)) / velocity).max(axis=(1, 2))
    hard = (np.abs(curve(inside, 2)) / acceleration).max(axis=(1, 2))
    return np.maximum(fast, 1.0), np.maximum(hard, 1.0)


def _both_ends(cells: Float[Array, "cells"]) -> Float[Array, "grid"]:
    """What holds for cells, for the points at their ends: the larger of both sides."""
    return np.maximum(np.concatenate([cells, [1.0]]), np.concatenate([[1.0], cells]))


def _smooth(q: Float[Array, "points n"]) -> tuple[Array | None, Array, Array, Array]:
    """Path parameter, path and its first two derivatives on an even grid; None where nothing moves."""
    from scipy.interpolate import CubicSpline

    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(q, axis=0), axis=1))])
    moving = np.concatenate([[True], np.diff(length) > 1e-12])
    if moving.sum() < 2:
        return None, q, q, q
    spline = CubicSpline(length[moving], q[moving], bc_type="natural") if moving.sum() > 2 else None
    s = np.linspace(0, length[-1], GRID)
    if spline is None:
        direction = (q[-1] - q[0]) / length[-1]
        path = q[0] + s[:, None] * direction
        return s, path, np.tile(direction, (GRID, 1)), np.zeros_like(path)
    return s, spline(s), spline(s, 1), spline(s, 2)


def _square_limits(first: Float[Array, "grid n"], velocity: Float[Array, "n"]) -> Float[Array, "grid"]:
    return np.min((velocity / np.maximum(np.abs(first), 1e-12)) ** 2, axis=1)


def _bounds(
    first: Float[Array, "n"], second: Float[Array, "n"], acceleration: Float[Array, "n"]
) -> tuple[Array, Array, Array]:
    """Acceleration along the path lies in ``slope x - room`` to ``slope x + room``, x the speed squared.

    One pair for each joint that moves along the path here.
    """
    moved = np.abs(first) > 1e-9
    return moved, -second[moved] / first[moved], acceleration[moved] / np.abs(first[moved])


def _pushes(
    first: Float[Array, "n"], second: Float[Array, "n"], acceleration: Float[Array, "n"], square: float
) -> tuple[float, float]:
    """Least and greatest acceleration along the path at a speed squared."""
    _, slope, room = _bounds(first, second, acceleration)
    return float((slope * square - room).max()), float((slope * square + room).min())


def _most(
    first: Float[Array, "n"],
    second: Float[Array, "n"],
    acceleration: Float[Array, "n"],
    fastest: float,
    after: float,
    step: float,
) -> float:
    """Greatest speed squared from which the next point can be passed at no more than `after`.

    Every bound is linear in the speed squared and holds standing still: the first to be met counts.
    """
    moved, slope, room = _bounds(first, second, acceleration)
    rise = np.concatenate([(slope[:, None] - slope).ravel(), slope + 1 / (2 * step), np.abs(second[~moved])])
    space = np.concatenate([(room[:, None] + room).ravel(), room + after / (2 * step), acceleration[~moved]])
    rising = rise > 1e-12
    return float(min(fastest, np.min(space[rising] / rise[rising], initial=np.inf)))
