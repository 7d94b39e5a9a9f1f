"""Residuals of arm against pictures: zero at the truth, and their derivatives by finite differences."""

from dataclasses import replace

import numpy as np
import pytest

from tests.hand_eye_sets import posed
from vision_robot.arm import read_arm
from vision_robot.calibrate.hand_eye.arm import ArmGeometry, GivenPoses
from vision_robot.calibrate.hand_eye.arm_residuals import arm_residuals, arm_rows
from vision_robot.calibrate.hand_eye.board_poses import find_board_poses
from vision_robot.calibrate.hand_eye.setup import SETUPS, setup_named
from vision_robot.calibrate.hand_eye.state import HandEyeState

NONE = np.zeros(10, dtype=bool)


def state(setup: str, **options) -> HandEyeState:
    made = posed(setup, 4, **options)
    views, _, _ = find_board_poses(made.corners, made.board, made.camera)
    pictures = replace(views.state, cam_from_board=made.cam_from_board)
    ends = setup_named(setup).fixed_and_carried(made.truth.mount_from_cam, made.truth.far_from_board)
    return HandEyeState(setup_named(setup), *ends, pictures, GivenPoses(made.said))


@pytest.mark.parametrize("setup", SETUPS)
def test_nothing_is_left_at_the_truth(setup):
    assert np.abs(arm_residuals(state(setup, turn=0.0, shift_m=0.0))).max() < 1e-12


@pytest.mark.parametrize("setup", SETUPS)
def test_the_residual_is_the_arms_own_error(setup):
    """Turn and shift in base axes, whatever is carried."""
    made = posed(setup, 4, turn=1e-3, shift_m=1e-3)
    found = arm_residuals(state(setup, turn=1e-3, shift_m=1e-3))
    assert np.allclose(found[:, 3:], made.said.translation - made.base_from_wrist.translation, atol=1e-12)
    assert np.allclose(np.linalg.norm(found[:, :3], axis=1), 1e-3, atol=2.5e-3)


@pytest.mark.parametrize("setup", SETUPS)
def test_derivatives(setup):
    at, step = state(setup, turn=1e-3, shift_m=1e-3), 1e-6
    rows = arm_rows(at)
    still, four = np.zeros(12), np.zeros((4, 6))
    for k in range(12):
        ahead, back = (arm_residuals(at.moved(NONE, sign * step * np.eye(12)[k], four)) for sign in (1, -1))  # pyright: ignore
        assert np.allclose((ahead - back) / (2 * step), rows.in_shared[:, :, k], atol=2e-6)
    for k in range(6):
        nudge = np.tile(step * np.eye(6)[k], (4, 1))
        ahead, back = (arm_residuals(at.moved(NONE, still, sign * nudge)) for sign in (1, -1))  # pyright: ignore
        assert np.allclose((ahead - back) / (2 * step), rows.in_pose[:, :, k], atol=2e-6)


def test_derivatives_in_the_arms_links():
    chain = read_arm("column").chain
    joints = np.random.default_rng(0).uniform(chain.limits[:, 0], chain.limits[:, 1], (4, 5))
    arm = ArmGeometry.of(chain, joints)
    at = state("eye-in-hand")
    at = replace(at, arm=arm)
    # Start where arm and pictures agree, so that residuals are small.
    at = replace(at, base_from_fixed=at.base_from_fixed)
    jacobian, step = arm.jacobian(), 1e-5
    for k in range(arm.count):
        ahead, back = (arm.moved(sign * step * np.eye(arm.count)[k]).base_from_wrist for sign in (1, -1))
        shift = (ahead.translation - back.translation) / (2 * step)
        assert np.allclose(shift, jacobian[:, 3:, k], atol=1e-8)
