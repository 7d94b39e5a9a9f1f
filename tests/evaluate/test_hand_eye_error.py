"""Errors of a hand-eye against the truth: in its own perturbation, in its own sigmas."""

import numpy as np

from tests.views import CAMERAS
from vision_robot.evaluate.hand_eye import hand_eye_error
from vision_robot.geometry import SE3, HandEye, rotation_exp


def test_a_known_step_is_found():
    truth = HandEye(
        "eye-in-hand", CAMERAS["pinhole"], SE3.exp(np.ones(6)), SE3.exp(-np.ones(6)), np.zeros((12, 12))
    )
    step = np.array([1e-3, 0, 0, 0, 2e-3, 0])
    moved = SE3(
        rotation_exp(step[:3]) @ truth.mount_from_cam.rotation, truth.mount_from_cam.translation + step[3:]
    )
    sigma = np.full(12, 1e-3)
    found = HandEye("eye-in-hand", truth.camera, moved, truth.far_from_board, np.diag(sigma**2))
    error = hand_eye_error(found, truth)
    assert np.allclose(error.step[:6], step, atol=1e-12)
    assert np.allclose(error.in_sigma[:6], step / 1e-3, atol=1e-9)
    assert np.isclose(error.position_m, 2e-3)
    assert np.isclose(error.turn, 1e-3)
    assert np.isclose(error.chance, np.exp(-2.5) * (1 + 2.5 + 2.5**2 / 2))  # chi-square of 5, six degrees
