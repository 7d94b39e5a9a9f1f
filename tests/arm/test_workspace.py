"""The workspace map: the annulus that follows from the links and limits by hand."""

import numpy as np
import pytest

from vision_robot.arm import read_arm
from vision_robot.arm.ik import InverseKinematics, Method
from vision_robot.arm.workspace import manipulability, tool_down, workspace

ARM = read_arm("column")


def test_tool_down_points_down_and_turns_by_its_yaw():
    turn = tool_down(np.array([0.0, 0.4]))
    assert np.allclose(turn[:, :, 2], [0, 0, -1])
    assert np.allclose(turn[1, :, 0], [np.cos(0.4), np.sin(0.4), 0])
    assert np.allclose(np.linalg.det(turn), 1)


@pytest.mark.parametrize("method", [Method.AUTO, Method.NUMERIC])
def test_the_column_arm_reaches_its_annulus(method):
    """Links of 300 and 250 mm, theta3 within 155 deg: 550 mm out, in to the third side of their triangle."""
    inner = np.sqrt(0.3**2 + 0.25**2 - 2 * 0.3 * 0.25 * np.cos(np.radians(25)))
    found = workspace(InverseKinematics(ARM, method=method), cells=41)
    assert 0.05 <= found.height_m <= 0.45  # d1 holds the tool 50 to 450 mm over the base
    x, y = np.meshgrid(found.level.across_m, found.level.up_m)
    radius, ahead = np.hypot(x, y), np.abs(np.arctan2(y, x)) < np.radians(140)
    assert found.level.reached[(radius > inner + 0.002) & (radius < 0.548) & ahead].all()
    assert not found.level.reached[(radius < inner - 0.002) | (radius > 0.552)].any()
    z = found.upright.up_m
    rows = found.upright.reached.any(axis=1)
    assert z[rows].min() >= 0.05 - 1e-9
    assert z[rows].max() <= 0.45 + 1e-9
    assert np.isnan(found.level.manipulability[~found.level.reached]).all()


def test_manipulability_by_hand():
    """Only d1 moves z, at right angles to the rest: l1 l2 |sin theta3|."""
    q = np.array([0.1, 0.3, 0.9, 0.0, 0.2])
    J = ARM.chain.jacobian(q)[:, :3]
    assert manipulability(J) == pytest.approx(0.3 * 0.25 * np.sin(0.9))
