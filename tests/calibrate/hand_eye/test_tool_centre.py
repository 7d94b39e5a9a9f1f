"""The tool's tip from touches: exact without noise, within its sigma with it, wider for loose touches."""

import numpy as np
import pytest

from tests.hand_eye_sets import SHIFT_M, TURN, posed
from vision_robot.calibrate.hand_eye import HandEyeSettings, calibrate_hand_eye
from vision_robot.calibrate.hand_eye.tool_centre import tool_centre
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, rotation_exp

TIP = np.array([0.01, -0.005, 0.15])


def touches(made, n: int, rng, turn: float = 0.0, shift_m: float = 0.0) -> tuple[SE3, np.ndarray]:
    """Poses whose tip is at board points, as the arm says them."""
    points = made.board[rng.choice(len(made.board), n, replace=False)]
    R = rotation_exp(rng.normal(size=(n, 3)) * 0.6)
    at = made.truth.far_from_board.apply(points) - R @ TIP
    said = SE3(rotation_exp(turn * rng.normal(size=(n, 3))) @ R, at + shift_m * rng.normal(size=(n, 3)))
    return said, points


def solved(seed: int, **noise):
    made = posed(seed=seed, **noise)
    result = calibrate_hand_eye(made.corners, made.said, made.board, made.camera, HandEyeSettings(made.setup))
    return made, result


def test_without_noise_the_truth():
    made, result = solved(1, noise_px=1e-4, turn=0.0, shift_m=0.0)
    found = tool_centre(result, *touches(made, 4, np.random.default_rng(0)))
    assert np.allclose(found.point_m, TIP, atol=1e-5)


def test_with_the_arms_noise_within_its_sigma():
    scaled = []
    for seed in range(6):
        made, result = solved(seed)
        rng = np.random.default_rng(seed)
        for _ in range(10):
            found = tool_centre(result, *touches(made, 6, rng, TURN, SHIFT_M))
            scaled.append((found.point_m - TIP) / found.sigma_m)
    assert np.sqrt(np.mean(np.square(scaled))) == pytest.approx(1, abs=0.3)


def test_a_loose_touch_widens_the_sigma():
    made, result = solved(2)
    said, points = touches(made, 8, np.random.default_rng(1), TURN, SHIFT_M)
    tight = tool_centre(result, said, points)
    shaken = SE3(said.rotation, said.translation + 3e-3 * np.random.default_rng(2).normal(size=(8, 3)))
    loose = tool_centre(result, shaken, points)
    assert loose.scatter > 3
    assert loose.sigma_m.max() > 3 * tight.sigma_m.max()
    assert loose.rms_m > 1e-3 > tight.rms_m


def test_what_makes_no_sense_is_refused():
    made, result = solved(3)
    said, points = touches(made, 4, np.random.default_rng(0))
    with pytest.raises(BadParameter, match="3 or more"):
        tool_centre(result, said[:2], points[:2])
    other = posed("eye-to-hand", seed=3)
    settings = HandEyeSettings("eye-to-hand")
    carried = calibrate_hand_eye(other.corners, other.said, other.board, other.camera, settings)
    with pytest.raises(BadParameter, match="eye-in-hand"):
        tool_centre(carried, said, points)
