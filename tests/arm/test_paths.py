"""Paths: on their line, on one branch, and refused where no branch holds."""

import numpy as np
import pytest

from vision_robot.arm import read_arm
from vision_robot.arm.ik import InverseKinematics, Method
from vision_robot.arm.paths import follow, line
from vision_robot.arm.workspace import tool_down
from vision_robot.errors import BadPath
from vision_robot.geometry import SE3

ARM = read_arm("column")


def pose(x: float, y: float, z: float, yaw: float = 0.0) -> SE3:
    return SE3(tool_down(np.array(yaw)), np.array([x, y, z]))


def test_a_line_is_straight_and_turns_evenly():
    poses = line(pose(0.3, -0.2, 0.1), pose(0.3, 0.2, 0.3, 1.0))
    steps = np.diff(poses.translation, axis=0)
    assert np.allclose(steps, steps[0])
    assert np.linalg.norm(steps[0]) <= 0.002 + 1e-12
    turns = SE3(np.swapaxes(poses.rotation[:-1], 1, 2) @ poses.rotation[1:], steps).rotvec()
    assert np.allclose(turns, turns[0], atol=1e-12)
    assert np.allclose(poses.as_matrix()[-1], pose(0.3, 0.2, 0.3, 1.0).as_matrix())


@pytest.mark.parametrize("method", [Method.AUTO, Method.NUMERIC])
def test_the_tool_stays_on_the_line_without_a_jump(method):
    ik = InverseKinematics(ARM, method=method)
    poses = line(pose(0.35, -0.3, 0.1), pose(0.35, 0.3, 0.15, 1.5))
    path = follow(ik, poses)
    reached = ARM.chain.base_from_tool(path.q)
    assert np.abs(reached.translation - poses.translation).max() < 1e-6
    assert np.abs(np.diff(path.q, axis=0)).max() < 0.02
    assert ARM.chain.within_limits(path.q).all()
    # Between the points too: the joints move straight and the tool nearly so.
    halfway = ARM.chain.base_from_tool((path.q[1:] + path.q[:-1]) / 2).translation
    assert np.abs(halfway - (poses.translation[1:] + poses.translation[:-1]) / 2).max() < 2e-5


def test_the_branch_nearest_to_the_present_joints_is_kept():
    ik = InverseKinematics(ARM)
    poses = line(pose(0.35, -0.1, 0.1), pose(0.35, 0.1, 0.1))
    for start in ik.branches(poses[:1]).of_goal(0):
        path = follow(ik, poses, near=start + 0.02)
        assert np.allclose(path.q[0], start, atol=1e-9)


def test_a_line_through_the_column_is_refused_with_how_far_it_goes():
    with pytest.raises(BadPath, match=r"followed for .* % of its way: theta3 is at its limit") as refused:
        follow(InverseKinematics(ARM), line(pose(0.35, -0.01, 0.1), pose(-0.35, 0.01, 0.1)))
    assert 0.1 < refused.value.share < 0.5


def test_a_line_that_begins_out_of_reach_is_refused():
    with pytest.raises(BadPath, match="first pose cannot be reached"):
        follow(InverseKinematics(ARM), line(pose(0.9, 0, 0.1), pose(0.3, 0, 0.1)))
