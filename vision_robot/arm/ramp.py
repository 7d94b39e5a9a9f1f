"""From rest to rest straight in joint space: the ramp, which has a closed form."""

import numpy as np

from vision_robot.arm.timing import Trajectory
from vision_robot.types import Array, Float

__all__ = ["ramp"]


def ramp(
    joint_names: tuple[str, ...],
    start: Float[Array, "n"],
    end: Float[Array, "n"],
    *,
    velocity: Float[Array, "n"],
    acceleration: Float[Array, "n"],
) -> Trajectory:
    """The fastest straight motion within each joint's limits [SI]: speed up, keep on, brake.

    What `timed` finds on its grid, exactly and in microseconds.
    """
    way = np.asarray(end, dtype=float) - start
    share = np.abs(way)
    if not share.max(initial=0.0) > 1e-12:
        still = np.zeros((1, len(way)))
        return Trajectory(joint_names, np.zeros(1), np.asarray(start, dtype=float)[None], still, still)
    # The way is walked from 0 to 1: its speed and push are bounded by the tightest joint.
    with np.errstate(divide="ignore", over="ignore"):
        fastest, push = float((velocity / share).min()), float((acceleration / share).min())
    fastest = min(fastest, float(np.sqrt(push)))
    rising, whole = fastest / push, 1 / fastest + fastest / push
    times = np.array([0.0, rising, whole - rising, whole])
    at = np.array([0.0, 0.5 * push * rising**2, 1 - 0.5 * push * rising**2, 1.0])
    speed = np.array([0.0, fastest, fastest, 0.0])
    pushes = np.array([push, 0.0, -push, -push])
    keep = np.concatenate([[True], np.diff(times) > 1e-12])
    rows = [np.outer(values[keep], way) for values in (at, speed, pushes)]
    return Trajectory(joint_names, times[keep], start + rows[0], rows[1], rows[2])
