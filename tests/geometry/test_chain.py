"""The serial chain: laws of its kinematics, and MuJoCo's own answer for the project's arm."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, SerialChain

RNG = np.random.default_rng(4)


def chain(n: int = 5) -> SerialChain:
    return SerialChain(
        joint_names=tuple(f"q{i}" for i in range(n)),
        slides=RNG.random(n) < 0.4,
        axes=RNG.normal(size=(n, 3)),
        link_from_joint=SE3.exp(RNG.normal(size=(n, 6))),
        last_from_wrist=SE3.exp(RNG.normal(size=6)),
        limits=np.tile([-2.0, 2.0], (n, 1)),
        wrist_from_tool=SE3.exp(RNG.normal(size=6)),
    )


def test_a_planar_arm_by_hand():
    """Two links of 1 m that turn about z: at (90, -90) degrees the tip is at (1, 1)."""
    two = SerialChain(
        ("a", "b"),
        np.array([False, False]),
        np.array([[0.0, 0, 1], [0, 0, 2]]),
        SE3(np.tile(np.eye(3), (2, 1, 1)), np.array([[0.0, 0, 0], [1, 0, 0]])),
        SE3(np.eye(3), np.array([1.0, 0, 0])),
        np.array([[-3.0, 3], [-3, 3]]),
        SE3.identity(),
    )
    tip = two.base_from_wrist(np.radians([90.0, -90.0]))
    assert np.allclose(tip.translation, [1, 1, 0])
    assert np.allclose(tip.rotation, np.eye(3))


def test_the_jacobian_is_the_derivative():
    arm, step = chain(), 1e-6
    q = RNG.uniform(-2, 2, size=(7, 5))
    J = arm.jacobian(q)
    for i in range(5):
        ahead, back = (arm.base_from_tool(q + sign * step * np.eye(5)[i]) for sign in (1, -1))
        move = (ahead.translation - back.translation) / (2 * step)
        turn = SE3(ahead.rotation @ np.swapaxes(back.rotation, -1, -2), 0 * move).rotvec() / (2 * step)
        assert np.allclose(J[..., :3, i], move, atol=1e-8)
        assert np.allclose(J[..., 3:, i], turn, atol=1e-8)


def test_limits_and_their_slack():
    arm = chain()
    q = np.zeros((2, 5))
    q[1, 3] = 2.1
    assert arm.within_limits(q).tolist() == [True, False]
    assert arm.within_limits(q, slack=0.2).all()


@pytest.mark.parametrize("change", [{"axes": np.zeros((5, 3))}, {"limits": np.tile([1.0, -1.0], (5, 1))}])
def test_what_is_no_chain_is_refused(change):
    arm = chain()
    fields = {name: getattr(arm, name) for name in arm.__dataclass_fields__}
    with pytest.raises(BadParameter, match="chain"):
        SerialChain(**{**fields, **change})


def test_a_wrong_number_of_joints_is_refused():
    with pytest.raises(BadParameter, match="joint values"):
        chain().base_from_wrist(np.zeros(4))
