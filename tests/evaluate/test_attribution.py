"""Attribution of an error to stages: the laws that define Shapley's value, and cases by hand."""

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_robot.errors import BadParameter
from vision_robot.evaluate.attribution import attribute, subsets

STAGES: tuple[str, ...] = ("calibration", "tracking", "plane", "ik", "control")


def errors_of(costs: Mapping[str, float]) -> dict[frozenset[str], float]:
    """Errors that simply add."""
    return {mended: sum(costs[s] for s in STAGES if s not in mended) for mended in subsets(STAGES)}


def test_errors_that_add_are_given_back():
    costs = dict(zip(STAGES, (0.5, 1.0, 0.0, 0.25, 2.0), strict=True))
    found = attribute(STAGES, errors_of(costs))
    for stage, cost in costs.items():
        assert found.share[stage] == pytest.approx(cost)
        assert found.alone[stage] == pytest.approx(cost)
        assert found.last[stage] == pytest.approx(cost)


def test_independent_errors_add_in_squares():
    """3 and 4 make 5: each is worth more alone than last, and the shares lie between and add up."""
    error = {frozenset(): 5.0, frozenset("a"): 4.0, frozenset("b"): 3.0, frozenset("ab"): 0.0}
    found = attribute(("a", "b"), error)
    assert found.share == pytest.approx({"a": 2.0, "b": 3.0})
    assert found.alone == pytest.approx({"a": 1.0, "b": 2.0})
    assert found.last == pytest.approx({"a": 3.0, "b": 4.0})


@given(st.lists(st.floats(0, 10), min_size=32, max_size=32))
def test_shares_add_up_and_whoever_does_nothing_gets_nothing(values):
    error = dict(zip(subsets(STAGES), values, strict=True))
    found = attribute(STAGES, error)
    assert sum(found.share.values()) == pytest.approx(found.total - found.floor, abs=1e-9)
    idle = {mended: error[mended - {"ik"}] for mended in subsets(STAGES)}
    assert attribute(STAGES, idle).share["ik"] == pytest.approx(0, abs=1e-9)


def test_equals_get_equal_shares():
    by_size = {mended: float(np.cos(len(mended))) for mended in subsets(STAGES)}
    shares = list(attribute(STAGES, by_size).share.values())
    assert np.ptp(shares) == pytest.approx(0, abs=1e-12)


def test_a_missing_run_is_named():
    error = errors_of(dict.fromkeys(STAGES, 1.0))
    del error[frozenset({"plane"})]
    with pytest.raises(BadParameter, match="plane"):
        attribute(STAGES, error)
