"""Restricted maximum likelihood: hand-worked where it has a closed form, unbiased over trials."""

import numpy as np
import pytest

from vision_robot.calibrate.hand_eye.arm_noise import LEAST, estimate_noise
from vision_robot.calibrate.hand_eye.problem import ArmNoise
from vision_robot.calibrate.hand_eye.reduced import Reduced


def problem(residual: np.ndarray, design: np.ndarray, pictures: float = 0.0) -> Reduced:
    n, s = len(residual), design.shape[2]
    return Reduced(residual, design, np.tile(pictures * np.eye(6), (n, 1, 1)), np.zeros((s, s)), np.zeros(s))


def test_with_perfect_pictures_it_divides_by_the_degrees_of_freedom():
    """One common offset of turn and shift: the sample variance about the mean, over n - 1."""
    rng = np.random.default_rng(0)
    residual = rng.normal(size=(9, 6)) * np.repeat([1e-3, 2e-3], 3) + 0.01
    found = estimate_noise(problem(residual, np.tile(np.eye(6), (9, 1, 1))), ArmNoise(1e-2, 1e-2))
    by_hand = np.sqrt(residual.var(axis=0, ddof=1).reshape(2, 3).mean(axis=1))
    assert np.allclose([found.noise.turn, found.noise.shift_m], by_hand, rtol=1e-3)
    assert np.allclose(found.relative_sigma, 1 / np.sqrt(2 * 24), rtol=1e-3)


def test_the_pictures_part_is_taken_off():
    rng = np.random.default_rng(1)
    residual = rng.normal(size=(400, 6)) * 1e-3 * np.sqrt(1 + 4)
    found = estimate_noise(problem(residual, np.zeros((400, 6, 0)), pictures=4e-6), ArmNoise(1e-2, 1e-2))
    assert found.noise.turn == pytest.approx(1e-3, rel=0.15)


def test_an_arm_without_error_ends_at_the_least():
    residual = np.zeros((9, 6))
    found = estimate_noise(problem(residual, np.tile(np.eye(6), (9, 1, 1)), 1e-6), ArmNoise(1e-3, 1e-3))
    assert found.noise.turn == pytest.approx(LEAST.turn)
    assert found.noise.shift_m == pytest.approx(LEAST.shift_m)
