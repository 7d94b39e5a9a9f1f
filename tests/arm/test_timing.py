"""Timing: fastest by hand-worked cases, and inside every limit at every time."""

import numpy as np
import pytest

from vision_robot.arm.timing import timed
from vision_robot.errors import BadParameter

NAMES = ("a", "b")
VELOCITY, ACCELERATION = np.array([1.0, 2.0]), np.array([4.0, 3.0])


def along(q, velocity=VELOCITY, acceleration=ACCELERATION):
    return timed(NAMES, np.asarray(q, dtype=float), velocity=velocity, acceleration=acceleration)


def test_a_long_move_is_a_trapezoid():
    """One radian at 1 rad/s and 4 rad/s^2: 1/v + v/a seconds."""
    assert along([[0, 0], [1, 0]]).seconds == pytest.approx(1 + 1 / (4), rel=2e-3)


def test_a_short_move_is_a_triangle():
    """0.09 rad at 4 rad/s^2 never reaches 1 rad/s: 2 sqrt(d / a) seconds."""
    assert along([[0, 0], [0.09, 0]]).seconds == pytest.approx(2 * np.sqrt(0.09 / (4)), rel=5e-3)


def test_the_slower_joint_sets_the_pace():
    """b: 3 rad at 2 rad/s and 3 rad/s^2; a goes along."""
    assert along([[0, 0], [0.3, 3]]).seconds == pytest.approx(1.5 + 2 / (3), rel=2e-3)


def test_a_curved_path_keeps_to_all_limits_at_all_times_and_ends_at_rest():
    s = np.linspace(0, 2 * np.pi, 300)[:, None]
    motion = along(np.hstack([np.sin(s), 0.7 * np.sin(2 * s)]))
    assert (np.abs(motion.velocity) <= VELOCITY * 1.001).all()
    assert (np.abs(motion.acceleration) <= ACCELERATION * 1.001).all()
    times = np.linspace(0, motion.seconds, 4001)
    q = motion.at(times)
    velocity = np.gradient(q, times, axis=0)
    assert (np.abs(velocity) <= VELOCITY * 1.01).all()
    assert (np.abs(np.gradient(velocity, times, axis=0)) <= ACCELERATION * 1.01).all()
    assert np.allclose(velocity[[0, -1]], 0, atol=0.03)
    assert np.allclose(q[[0, -1]], [[0, 0], [0, 0]], atol=1e-9)
    # Somewhere a limit is met: else it could be faster.
    assert (np.abs(motion.velocity) / VELOCITY).max() > 0.99 or (
        np.abs(motion.acceleration) / ACCELERATION
    ).max() > 0.95


def test_standing_still_takes_no_time():
    assert along([[0.3, 0.2], [0.3, 0.2]]).seconds == 0


@pytest.mark.parametrize("limits", [np.array([1.0]), np.array([1.0, 0.0]), np.array([1.0, np.inf])])
def test_limits_must_be_positive_numbers_one_a_joint(limits):
    with pytest.raises(BadParameter, match="velocity limits"):
        along([[0, 0], [1, 0]], velocity=limits)
