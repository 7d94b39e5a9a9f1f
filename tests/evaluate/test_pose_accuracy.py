"""ISO 9283: a bias is accuracy, a spread is repeatability, and neither sees the other."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.evaluate.pose_accuracy import pose_accuracy
from vision_robot.geometry import SE3

RNG = np.random.default_rng(0)
COMMANDED = SE3.exp(np.array([0.2, -0.1, 0.3, 0.5, 0.2, -1.0]))


def attained(offset: np.ndarray, turn: np.ndarray) -> SE3:
    still = np.zeros((len(turn), 2))
    turned = SE3.from_rotvec(np.column_stack([still, turn]), np.zeros((len(turn), 3)))
    return SE3(COMMANDED.rotation @ turned.rotation, COMMANDED.translation + offset)


def test_a_constant_offset_is_accuracy_alone():
    found = pose_accuracy(COMMANDED, attained(np.tile([0.003, 0, 0.004], (30, 1)), np.full(30, 0.02)))
    assert found.accuracy_m == pytest.approx(0.005)
    assert found.repeatability_m == pytest.approx(0, abs=1e-12)
    assert found.yaw_accuracy_rad == pytest.approx(0.02)
    assert found.yaw_repeatability_rad == pytest.approx(0, abs=1e-9)


def test_four_points_of_a_square_by_hand():
    """All 1 mm from their middle: l = 1 mm without spread, so RP = 1 mm and AP = 0."""
    square = 1e-3 * np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
    found = pose_accuracy(COMMANDED, attained(square, np.zeros(4)))
    assert found.accuracy_m == pytest.approx(0, abs=1e-12)
    assert found.repeatability_m == pytest.approx(1e-3)


def test_yaw_at_half_a_turn_does_not_jump():
    turn = np.pi + RNG.normal(0, 0.01, 200)
    found = pose_accuracy(COMMANDED, attained(np.zeros((200, 3)), turn))
    assert found.yaw_accuracy_rad == pytest.approx(np.pi, abs=0.01)
    assert found.yaw_repeatability_rad == pytest.approx(0.03, rel=0.2)


def test_one_pose_has_no_repeatability():
    with pytest.raises(BadParameter, match="attained poses"):
        pose_accuracy(COMMANDED, attained(np.zeros((1, 3)), np.zeros(1)))
