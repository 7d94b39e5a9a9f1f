"""Suite `ik`: closed form and iteration reach all goals, the drawing of another arm reaches none."""

import numpy as np
import pytest

from vision_robot.arm.urdf import read_urdf
from vision_robot.errors import BadParameter
from vision_robot.evaluate.peers.kinematics import KNOWN, ik_peer, urdf_text
from vision_robot.evaluate.sweep.cell import measure
from vision_robot_synth.published_arms import PUMA_560
from vision_robot_synth.suites import Plan, suite_named
from vision_robot_synth.suites.ik import ARMS, ik_figures


@pytest.fixture(autouse=True, scope="module")
def cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.mark.parametrize("arm", ["column", "ur5e", "puma-560"])
def test_a_closed_form_reaches_all(arm, tmp_path):
    found = ik_figures(tmp_path, arm, "vr-closed-form", seed=0, goals=40)
    assert (found["ik_success"], found["ik_wrong"]) == (1, 0)
    assert found["ik_position_error_mm"] < 1e-9


def test_the_numeric_search_reaches_all_of_seven_joints(tmp_path):
    found = ik_figures(tmp_path, "panda", "vr-numeric", seed=0, goals=20)
    assert (found["ik_success"], found["ik_wrong"]) == (1, 0)


def test_an_arm_that_was_measured_is_reached_and_its_drawing_misses(tmp_path):
    known = ik_figures(tmp_path, "column-off", "vr", seed=0, goals=10)
    drawn = ik_figures(tmp_path, "column-off", "vr-as-drawn", seed=0, goals=10)
    assert known["ik_success"] == 1
    assert drawn["ik_success"] == 0
    assert 1 < drawn["ik_position_error_mm"] < 20
    assert known["ik_position_error_mm"] < 1e-3


def test_no_closed_form_is_a_failure_with_its_reason(tmp_path):
    (cell,) = (
        c for c in suite_named("ik").cells(Plan(("panda",), ("vr-closed-form",), seeds=1)) if not c.alone
    )
    found = measure(cell, tmp_path)
    assert found.figures == {}
    assert found.failure is not None
    assert found.failure.startswith("UnknownStructure")


def test_goals_differ_by_seed_and_are_the_same_for_all_methods(tmp_path):
    """What is drawn hangs on arm and seed alone, so methods are compared on the same goals."""
    from vision_robot_synth.suites.ik import _goals

    chain = ARMS["column"]().chain
    first, again, other = (_goals(chain, seed, 5).as_matrix() for seed in (0, 0, 1))
    assert np.array_equal(first, again)
    assert not np.allclose(first, other)


def test_ipopt_reaches_most(tmp_path):
    found = ik_figures(tmp_path, "column", "casadi-ipopt", seed=0, goals=5)
    assert found["ik_success"] >= 0.8
    assert found["ik_wrong"] == 0


def test_peers_read_the_same_arm(tmp_path):
    (tmp_path / "arm.urdf").write_text(urdf_text(PUMA_560))
    again = read_urdf(tmp_path / "arm.urdf").chain
    q = np.random.default_rng(0).uniform(*PUMA_560.limits.T, size=(20, 6))
    assert again.base_from_tool(q).as_matrix() == pytest.approx(
        PUMA_560.base_from_tool(q).as_matrix(), abs=1e-9
    )
    assert again.limits == pytest.approx(PUMA_560.limits)


@pytest.mark.parametrize("name", [name for name, (package, _) in KNOWN.items() if package != "casadi"])
def test_peers_that_are_installed_reach_most(name, tmp_path):
    pytest.importorskip(KNOWN[name][0])
    assert ik_figures(tmp_path, "puma-560", name, seed=0, goals=10)["ik_success"] >= 0.8


def test_a_peer_that_is_not_known_is_refused():
    with pytest.raises(BadParameter, match="casadi-ipopt"):
        ik_peer("nobody", PUMA_560)
