"""Closed forms: every joint vector comes back among the branches, and what is not known is refused."""

from dataclasses import replace

import numpy as np
import pytest

from tests.arm.arms import PANDA, PUMA_560, UR5E, column_elbow, rail_elbow, waist_elbow
from vision_robot.arm import read_arm
from vision_robot.arm.closed_form import closed_form_of, structure_of
from vision_robot.arm.vectorised import Vectorised
from vision_robot.errors import UnknownStructure
from vision_robot.geometry import SE3, SerialChain

KINDS = {
    "column, two upright axes, wrist pitch, roll": read_arm("column").chain,
    "column, waist, shoulder, elbow, roll": column_elbow(),
    "rail along the shoulder's axis, shoulder, elbow, wrist pitch, roll": rail_elbow(),
    "waist, shoulder, elbow, wrist pitch, roll": waist_elbow(),
    "waist, shoulder, elbow and a wrist whose three axes meet": PUMA_560,
    "waist, three parallel axes, two wrist axes": UR5E,
}


@pytest.mark.parametrize("name", KINDS)
def test_each_joint_vector_is_among_the_branches(name):
    chain = KINDS[name]
    form = closed_form_of(chain)
    assert form.structure == structure_of(chain) == name
    assert form.exact
    rng = np.random.default_rng(3)
    middle = chain.limits.mean(axis=1)
    half = np.minimum(np.diff(chain.limits, axis=1)[:, 0] / 2, np.pi)
    q = rng.uniform(middle - half, middle + half, size=(2000, len(chain)))
    goals = chain.base_from_tool(q).as_matrix()[:, :3].reshape(-1, 12)
    found, errors = Vectorised(form.function)(np.ascontiguousarray(goals.T))
    found = found.reshape(form.branches, len(chain), -1)
    nearest = np.abs(found - q.T).max(axis=1).min(axis=0)
    assert np.quantile(nearest, 0.99) < 1e-8
    assert nearest.max() < 1e-4  # near singular poses joints are known to the root of the rounding only
    # What the function says of its own errors is what the chain says.
    errors = errors.reshape(form.branches, 2, -1)
    for k in range(form.branches):
        reached = chain.base_from_tool(found[k].T)
        distance = np.linalg.norm(reached.translation - chain.base_from_tool(q).translation, axis=1)
        assert np.allclose(distance, errors[k, 0], atol=1e-12)
    assert np.all(np.min(errors.max(axis=1), axis=0) < 1e-9)


def test_straight_down_every_yaw_has_two_pitch_branches():
    """The pose that picking needs is where the pitch branches meet: it must not lose digits there."""
    chain = read_arm("column").chain
    form = closed_form_of(chain)
    q = np.array([0.1, 0.4, 0.9, 0.0, -1.2])
    goal = chain.base_from_tool(q).as_matrix()[:3].reshape(12, 1)
    found, errors = Vectorised(form.function)(goal)
    assert errors.max() < 1e-12
    assert np.abs(found.reshape(4, 5) - q).max(axis=1).min() < 1e-12


def test_seven_joints_are_refused_with_the_reason():
    with pytest.raises(UnknownStructure, match=r"RRRRRRR.*no kind that is known"):
        closed_form_of(PANDA)


def test_a_crooked_axis_is_named():
    chain = read_arm("column").chain
    axes = chain.axes.copy()
    axes[2] = [0.02, 0, 1]
    with pytest.raises(
        UnknownStructure, match=r"theta3 turns about the direction of d1, which is off by 0.02"
    ):
        closed_form_of(replace(chain, axes=axes))


def test_a_file_with_rounded_angles_is_known_but_not_exact():
    chain = read_arm("column").chain
    links = SE3(
        np.concatenate(
            [chain.link_from_joint.rotation[:4], SE3.exp(np.array([[0, 0, 0, 4e-6, 0, 0.0]])).rotation]
        ),
        chain.link_from_joint.translation,
    )
    form = closed_form_of(replace(chain, link_from_joint=links))
    assert not form.exact


def test_a_wrist_that_misses_its_centre_is_refused():
    """EAIK and its like read such arms as what they are not; here it is said."""
    shifted = PUMA_560.link_from_joint.translation.copy()
    shifted[5, 0] += 0.01
    chain: SerialChain = replace(PUMA_560, link_from_joint=SE3(PUMA_560.link_from_joint.rotation, shifted))
    with pytest.raises(UnknownStructure, match="q6 passes where they meet"):
        closed_form_of(chain)
