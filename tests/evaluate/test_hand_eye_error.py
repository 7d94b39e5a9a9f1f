"""Errors of a hand-eye against the truth: in its own perturbation, in its own sigmas."""

from dataclasses import replace

import numpy as np

from tests.views import CAMERAS
from vision_robot.arm import read_arm
from vision_robot.evaluate.hand_eye import hand_eye_error, place_errors
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


def test_what_moves_with_the_last_link_is_no_error_of_place():
    """A wrist frame chosen otherwise is made up for by the camera's place in it."""
    chain = read_arm("column").chain
    change = SE3.exp(0.1 * np.ones(6))
    other = replace(chain, last_from_wrist=chain.last_from_wrist @ change)
    joints = np.random.default_rng(0).uniform(chain.limits[:, 0], chain.limits[:, 1], (5, 5))
    ends = SE3.exp(np.ones(6)), SE3.exp(-np.ones(6))
    truth = HandEye("eye-in-hand", CAMERAS["pinhole"], *ends, np.zeros((12, 12)))
    same = replace(truth, mount_from_cam=change.inverse() @ truth.mount_from_cam)
    assert place_errors(same, other, truth, chain, joints).max() < 1e-12
    moved = replace(truth, mount_from_cam=SE3(ends[0].rotation, ends[0].translation + 1e-3 * np.eye(3)[2]))
    assert np.allclose(place_errors(moved, chain, truth, chain, joints), 1e-3)
