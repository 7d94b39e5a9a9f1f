"""Goals out of reach: what forbids them is named with the right numbers."""

import numpy as np
import pytest

from tests.arm.arms import UR5E
from vision_robot.arm import Arm, Task, read_arm
from vision_robot.arm.ik import InverseKinematics
from vision_robot.arm.starts import pose_weights
from vision_robot.arm.symbolic import base_from_tool
from vision_robot.arm.unreachable import Unreachable
from vision_robot.arm.workspace import tool_down
from vision_robot.geometry import SE3

ARM = read_arm("column")
IK = InverseKinematics(ARM, compiled=False)


def reason(rotation, translation, ik=IK):
    goals = SE3(np.asarray(rotation)[None], np.array([translation], dtype=float))
    found = ik.solve(goals)
    assert not found.converged[0]
    return Unreachable(ik).reason(goals, found, 0)


DOWN = tool_down(np.array(0.0))


def test_links_too_short_by_hand():
    """Tool down, 300 and 250 mm of links reach 550 mm; theta2 stands on the base's axis."""
    told = reason(DOWN, [0.6, 0, 0.2])
    assert told.kind == "length"
    assert "too short with this tilt by 50.0 mm: the tool reaches 550 mm" in told.text
    assert "from the axis of theta2, the goal is at 600 mm" in told.text


@pytest.mark.parametrize(
    ("translation", "said"),
    [
        ([0.4, 0, 0.9], "d1 would have to be 850.0 mm, its limit is 400.0"),
        ([0.05, 0, 0.2], "theta3 would have to be"),
        ([-0.54, 0, 0.1], "theta2 would have to be"),
    ],
)
def test_limits_are_named_with_what_would_be_needed(translation, said):
    told = reason(DOWN, translation)
    assert told.kind == "limit"
    assert said in told.text
    for obstacle in told.obstacles:
        low, high = ARM.chain.limits[ARM.chain.joint_names.index(obstacle.joint)]
        assert obstacle.limit in (low, high)
        assert not low <= obstacle.needed <= high


def test_a_wrist_past_its_limit_is_the_only_joint_named():
    q = np.array([0.2, 0.3, 0.8, np.radians(112), 0.3])
    goal = ARM.chain.base_from_tool(q)
    told = reason(goal.rotation, goal.translation)
    assert [obstacle.joint for obstacle in told.obstacles] == ["theta4"]
    assert np.degrees(told.obstacles[0].needed) == pytest.approx(112)
    assert np.degrees(told.obstacles[0].limit) == pytest.approx(100)


def test_five_joints_and_six_numbers():
    """Tilted about the direction in which the arm reaches: no column arm can."""
    tilted = SE3.exp(np.array([0, 0, 0, 0.3, 0, 0.0])).rotation @ DOWN
    told = reason(tilted, [0.4, 0.1, 0.2])
    assert told.kind == "orientation"
    assert "5 joints cannot meet all six numbers of a pose" in told.text
    assert (
        InverseKinematics(ARM, Task.TILT, compiled=False)
        .solve(SE3(tilted[None], np.array([[0.4, 0.1, 0.2]])))
        .converged[0]
    )


def test_six_joints_too_short():
    ik = InverseKinematics(Arm("ur5e", UR5E, "base", "tool"))
    told = reason(DOWN, [1.3, 0, 0.2], ik)
    assert told.kind == "length"
    assert "too short" in told.text


@pytest.mark.parametrize("translation", [[0.6, 0, 0.2], [0.4, 0.1, 0.7], [-0.54, 0, 0.1]])
def test_the_closest_pose_is_a_minimum_that_ipopt_cannot_better(translation):
    """IPOPT as reference, on the same distance, from the answer and from elsewhere."""
    import casadi as ca

    goals = SE3(DOWN[None], np.array([translation], dtype=float))
    ours = IK.solve(goals).q[0]
    goal = goals.as_matrix()[0, :3].ravel()
    q = ca.SX.sym("q", 5)
    off = base_from_tool(ARM.chain)(q) - goal
    weights = pose_weights(ARM.chain, Task.POSE)
    cost = ca.sumsqr(off * weights)
    solver = ca.nlpsol("closest", "ipopt", {"x": q, "f": cost}, {"print_time": False, "ipopt.print_level": 0})
    evaluate = ca.Function("cost", [q], [cost])
    low, high = ARM.chain.limits.T
    best = float(evaluate(ours))
    for start in (ours, np.zeros(5), [0.1, 1, 1, 0.2, 0], [0.1, -1, 2, 0.5, 1]):
        found = float(solver(x0=start, lbx=low, ubx=high)["f"])
        assert best <= found * 1.02 + 1e-9
