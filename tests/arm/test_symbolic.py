"""The CasADi functions: the chain's own kinematics, true derivatives, steps that end on the goal."""

import numpy as np
import pytest

from vision_robot.arm import Task, read_arm
from vision_robot.arm.symbolic import base_from_tool, jacobian, lm_step, residual
from vision_robot.geometry import SE3, SerialChain

RNG = np.random.default_rng(7)


def any_chain() -> SerialChain:
    n = 6
    return SerialChain(
        tuple("abcdef"),
        np.array([False, True, False, False, True, False]),
        RNG.normal(size=(n, 3)),
        SE3.exp(RNG.normal(size=(n, 6))),
        SE3.exp(RNG.normal(size=6)),
        np.tile([-2.0, 2.0], (n, 1)),
        SE3.exp(RNG.normal(size=6)),
    )


@pytest.mark.parametrize("chain", [read_arm("column").chain, any_chain()], ids=["column", "any"])
def test_kinematics_are_those_of_the_chain(chain):
    f, J = base_from_tool(chain), jacobian(chain)
    for q in RNG.uniform(*chain.limits.T, size=(20, len(chain))):
        pose = chain.base_from_tool(q).as_matrix()[:3].ravel()
        assert np.allclose(np.array(f(q)).ravel(), pose, rtol=0, atol=1e-13)
        assert np.allclose(np.array(J(q)), chain.jacobian(q), rtol=0, atol=1e-13)


@pytest.mark.parametrize("task", Task)
def test_the_residual_has_its_derivative_and_vanishes_on_the_goal(task):
    chain, h = any_chain(), 1e-6
    r = residual(chain, task)
    q = RNG.uniform(-1, 1, 6)
    goal = chain.base_from_tool(q).as_matrix()[:3].ravel()
    assert np.allclose(np.array(r(q, goal)[0]), 0, atol=1e-14)
    J = np.array(r(q, goal)[1])
    columns = [np.array(r(q + h * e, goal)[0] - r(q - h * e, goal)[0]).ravel() / (2 * h) for e in np.eye(6)]
    assert np.allclose(np.stack(columns, axis=1), J, atol=1e-8)


@pytest.mark.parametrize("task", Task)
def test_steps_end_on_the_goal_and_inside_the_limits(task):
    chain = read_arm("column").chain
    step, least, most = lm_step(chain, task), *chain.limits.T
    for q in RNG.uniform(least, most, size=(10, 5)):
        goal = chain.base_from_tool(q).as_matrix()[:3].ravel()
        at = np.clip(q + RNG.normal(scale=0.05, size=5), least, most)
        for _ in range(12):
            at = np.array(step(at, goal)[0]).ravel()
            assert chain.within_limits(at)
        assert np.array(step(at, goal)[1]).max() < 1e-9


def test_the_error_of_a_half_turn_is_not_taken_for_none():
    chain = read_arm("column").chain
    q = np.array([0.2, 0, 0, 0, -np.pi / 2])
    half_a_turn = np.array([0, 0, 0, 0, np.pi])
    goal = chain.base_from_tool(q + half_a_turn).as_matrix()[:3].ravel()
    assert float(residual(chain)(q, goal)[2][1]) == pytest.approx(2)
