"""Inverse kinematics: every reachable pose solved inside the limits, nothing called so that is not."""

from dataclasses import replace

import numpy as np
import pytest

from tests.arm.arms import PANDA, PUMA_560, UR5E, column_elbow, rail_elbow, waist_elbow
from vision_robot.arm import Arm, Task, read_arm
from vision_robot.arm.build import find_compiler
from vision_robot.arm.ik import InverseKinematics, Method
from vision_robot.arm.starts import windows
from vision_robot.errors import BadGoal, BadParameter, UnknownStructure
from vision_robot.geometry import SE3, SerialChain

COMPILED = [False, pytest.param(True, marks=pytest.mark.skipif(not find_compiler(), reason="no C compiler"))]
CHAINS = {
    "column": read_arm("column").chain,
    "column elbow": column_elbow(),
    "rail elbow": rail_elbow(),
    "waist elbow": waist_elbow(),
    "puma": PUMA_560,
    "ur5e": UR5E,
    "panda": PANDA,
}


def arm_of(chain: SerialChain) -> Arm:
    return Arm("test", chain, "base", "tool")


def goals_inside(chain: SerialChain, count: int, seed: int = 0) -> tuple[np.ndarray, SE3]:
    q = np.random.default_rng(seed).uniform(*windows(chain).T, size=(count, len(chain)))
    return q, chain.base_from_tool(q)


def misses(chain: SerialChain, q: np.ndarray, goals: SE3) -> tuple[np.ndarray, np.ndarray]:
    """Distance [m] and angle [rad] by the chain's own kinematics, not the solver's."""
    reached = chain.base_from_tool(q)
    turn = SE3(np.swapaxes(reached.rotation, -1, -2) @ goals.rotation, 0 * reached.translation).rotvec()
    return np.linalg.norm(reached.translation - goals.translation, axis=-1), np.linalg.norm(turn, axis=-1)


@pytest.mark.parametrize("compiled", COMPILED)
@pytest.mark.parametrize("method", [Method.NUMERIC, Method.AUTO])
@pytest.mark.parametrize("name", CHAINS)
def test_every_pose_inside_the_limits_is_reached(name, method, compiled):
    chain = CHAINS[name]
    ik = InverseKinematics(arm_of(chain), method=method, compiled=compiled)
    _, goals = goals_inside(chain, 1500)
    found = ik.solve(goals)
    distance, angle = misses(chain, found.q, goals)
    assert found.converged.all()
    assert chain.within_limits(found.q).all()
    assert distance.max() < 1e-6
    assert angle.max() < 1e-5
    assert np.allclose(found.position_error_m, distance, atol=1e-12)
    assert np.allclose(found.orientation_error_rad, angle, atol=2e-8)


@pytest.mark.parametrize("compiled", COMPILED)
def test_both_methods_agree_on_the_branches(compiled):
    """The numeric search, knowing nothing of the closed form, finds its branches and no other."""
    arm = read_arm("column")
    closed = InverseKinematics(arm, compiled=compiled)
    numeric = InverseKinematics(arm, method=Method.NUMERIC, compiled=compiled)
    q, goals = goals_inside(arm.chain, 20, seed=5)
    here, there = closed.branches(goals), numeric.branches(goals)
    for k in range(len(q)):
        one, other = here.of_goal(k), there.of_goal(k)
        assert len(one) == len(other) >= 1
        assert np.abs(one[:, None] - other).max(axis=2).min(axis=1).max() < 1e-5
        assert np.abs(one - q[k]).max(axis=1).min() < 1e-8


def test_tool_down_has_all_four_branches_and_the_nearest_is_taken():
    arm = read_arm("column")
    ik = InverseKinematics(arm)
    q = np.array([0.2, 0.3, 0.8, 0.0, 0.4])
    goal = arm.chain.base_from_tool(q)
    branches = ik.branches(goal).of_goal(0)
    assert len(branches) == 2  # elbow either way; both pitch branches are one when the tool points down
    for own in branches:
        found = ik.solve(goal, near=own + 0.01)
        assert np.allclose(found.q[0], own)


def test_joints_of_more_than_a_turn_are_wound_to_where_they_are():
    ik = InverseKinematics(arm_of(UR5E))
    q = np.radians([200.0, -60, 80, -250, 300, -310])
    found = ik.solve(UR5E.base_from_tool(q), near=q + 0.02)
    assert np.allclose(found.q[0], q, atol=1e-8)
    assert UR5E.within_limits(found.q).all()


@pytest.mark.parametrize("compiled", COMPILED)
def test_the_nearest_branch_is_the_nearest_that_the_limits_allow(compiled):
    """Whole turns that would pass a limit bring no branch nearer; looked for in all branches and turns."""
    ik = InverseKinematics(arm_of(UR5E), compiled=compiled)
    rng = np.random.default_rng(4)
    low, high = UR5E.limits.T
    q, near = (rng.uniform(low, high, size=(100, 6)) for _ in range(2))
    goals = UR5E.base_from_tool(q)
    found, branches = ik.solve(goals, near=near), ik.branches(goals)
    turns = 2 * np.pi * np.array([-1, 0, 1])
    for k in range(100):
        every = branches.of_goal(k)[:, :, None] + turns
        allowed = (every >= low[:, None]) & (every <= high[:, None])
        least = np.where(allowed, np.abs(every - near[k][:, None]), np.inf).min(axis=2)
        assert np.linalg.norm(found.q[k] - near[k]) == pytest.approx(np.linalg.norm(least, axis=1).min())


def test_without_present_joints_the_middle_of_the_ranges_is_preferred():
    arm = read_arm("column")
    ik = InverseKinematics(arm)
    _, goals = goals_inside(arm.chain, 50)
    found, branches = ik.solve(goals), ik.branches(goals)
    middle, size = arm.chain.limits.mean(axis=1), np.diff(arm.chain.limits, axis=1)[:, 0]
    for k in range(50):
        offs = (((branches.of_goal(k) - middle) / size) ** 2).sum(axis=1)
        assert (((found.q[k] - middle) / size) ** 2).sum() == pytest.approx(offs.min())


def test_a_measured_arm_is_solved_on_its_own_geometry():
    """1 mm and 0.3 degrees off: the drawn closed form misses by millimetres, the solver does not."""
    arm = read_arm("column")
    rng = np.random.default_rng(1)
    drawn = arm.chain
    twist = np.concatenate(
        [rng.normal(scale=1e-3, size=(5, 3)), rng.normal(scale=np.radians(0.3), size=(5, 3))], axis=1
    )
    measured = arm.calibrated(replace(drawn, link_from_joint=drawn.link_from_joint @ SE3.exp(twist)))
    _, goals = goals_inside(measured.chain, 500)
    naive = InverseKinematics(arm).solve(goals)
    assert np.median(misses(measured.chain, naive.q, goals)[0]) > 1e-3
    found = InverseKinematics(measured).solve(goals)
    assert found.converged.all()
    assert misses(measured.chain, found.q, goals)[0].max() < 1e-6
    assert (found.branch >= 0).mean() > 0.9
    with pytest.raises(BadParameter, match="joints of the calibrated chain"):
        arm.calibrated(UR5E)


@pytest.mark.parametrize("task", Task)
@pytest.mark.parametrize("compiled", COMPILED)
def test_a_task_asks_no_more_than_it_says(task, compiled):
    arm = read_arm("column")
    ik = InverseKinematics(arm, task, compiled=compiled)
    _, goals = goals_inside(arm.chain, 60)
    # Turned by what the task leaves free.
    about_tool = SE3.from_rotvec(np.array([0, 0, 0.7]), np.zeros(3))
    about_base = SE3.from_rotvec(np.array([0, 0, 0.7]), np.zeros(3)).rotation
    asked = {
        Task.POSE: goals,
        Task.AXIS: goals @ about_tool,
        Task.TILT: SE3(about_base @ goals.rotation, goals.translation),
        Task.POSITION: SE3(np.broadcast_to(np.eye(3), (60, 3, 3)), goals.translation),
    }[task]
    found = ik.solve(asked)
    assert found.converged.all()
    reached = arm.chain.base_from_tool(found.q)
    assert np.abs(reached.translation - asked.translation).max() < 1e-6
    if task in (Task.POSE, Task.AXIS):
        assert np.abs(reached.rotation[..., 2] - asked.rotation[..., 2]).max() < 1e-5
    if task in (Task.POSE, Task.TILT):
        assert np.abs(reached.rotation[:, 2] - asked.rotation[:, 2]).max() < 1e-5


def test_what_cannot_be_reached_is_not_called_reached():
    arm = read_arm("column")
    down = read_arm("column").chain.base_from_tool(np.zeros(5)).rotation
    places = np.array([[0.80, 0, 0.2], [0.05, 0, 0.2], [0.4, 0, 0.9], [0.4, 0, 0.2]])
    for ik in (InverseKinematics(arm), InverseKinematics(arm, method=Method.NUMERIC)):
        found = ik.solve(SE3(np.tile(down, (4, 1, 1)), places))
        assert found.converged.tolist() == [False, False, False, True]
        assert 0.19 < found.position_error_m[0] <= 0.25  # straight on it is 0.25 m; leaning over it is less
        assert arm.chain.within_limits(found.q).all()


def test_the_same_question_has_the_same_answer():
    _, goals = goals_inside(PANDA, 200)
    one, two = (InverseKinematics(arm_of(PANDA)).solve(goals).q for _ in range(2))
    assert np.array_equal(one, two)


def test_a_closed_form_that_is_not_known_is_refused_and_the_search_takes_over():
    with pytest.raises(UnknownStructure):
        InverseKinematics(arm_of(PANDA), method=Method.CLOSED_FORM)
    assert not InverseKinematics(arm_of(PANDA)).uses_closed_form


GOOD = SE3.identity(3)


@pytest.mark.parametrize(
    ("rotation", "translation", "said"),
    [
        (np.eye(3), [300.0, 0, 100], r"goal 1 .* 316\.\d m away and the arm reaches .* were millimetres"),
        (np.eye(3), [np.nan, 0, 0], "goal 1 .*not finite"),
        (np.eye(3) * 1.1, [0.3, 0, 0.1], "goal 1 .*not orthonormal"),
        (np.diag([1.0, 1, -1]), [0.3, 0, 0.1], "goal 1 .*mirrors"),
    ],
)
def test_what_can_be_no_goal_is_refused_by_row(rotation, translation, said):
    ik = InverseKinematics(read_arm("column"), compiled=False)
    goals = SE3(
        np.array([np.eye(3), rotation, np.eye(3)]), np.array([[0.3, 0, 0.1], translation, [0.3, 0, 0.1]])
    )
    with pytest.raises(BadGoal, match=said):
        ik.solve(goals)


def test_rounding_in_a_rotation_is_mended():
    arm = read_arm("column")
    q = np.array([0.2, 0.3, 0.8, 0.2, 0.4])
    goal = arm.chain.base_from_tool(q)
    found = InverseKinematics(arm, compiled=False).solve(SE3(np.round(goal.rotation, 5), goal.translation))
    assert found.orientation_error_rad[0] < 2e-5


def test_present_joints_of_another_arm_are_refused():
    ik = InverseKinematics(read_arm("column"), compiled=False)
    with pytest.raises(BadParameter, match="5 finite joint values"):
        ik.solve(SE3.identity(2), near=np.zeros(6))


def test_no_goals_no_answers():
    ik = InverseKinematics(read_arm("column"))
    assert len(ik.solve(SE3.identity(0))) == 0
