"""An error budget adds up, and says where what happened is not what was foretold."""

import pytest

from tests.picked import budget_runs as runs
from vision_robot.errors import BadParameter
from vision_robot.evaluate.error_budget import error_budget
from vision_robot.pick.budget import Counterfactuals
from vision_robot.pick.knowledge import STAGES


def test_shares_add_up_and_agree_with_what_was_foretold():
    budget = error_budget(runs())
    assert sum(budget.shares.share.values()) + budget.shares.floor == pytest.approx(budget.total_m.value)
    assert sum(budget.predicted_shares.share.values()) == pytest.approx(budget.predicted_m)
    assert budget.verdict() == "agrees"
    assert budget.ratio.low < 1 < budget.ratio.high
    assert max(budget.shares.share, key=lambda one: budget.shares.share[one]) == "tracking"
    assert budget.verdict("ik") == "agrees"  # nothing, as foretold


def test_an_error_that_no_covariance_holds_is_found_in_its_stage():
    budget = error_budget(runs(20, shift_m=0.005))
    assert budget.verdict() == "more"
    assert [one for one in STAGES if budget.verdict(one) == "more"] == ["plane"]


def test_few_seeds_settle_nothing():
    verdicts = {error_budget(runs(3, seed=s)).verdict("calibration") for s in range(12)}
    assert "open" in verdicts
    assert "more" not in verdicts


def test_runs_without_a_prediction_are_refused():
    with pytest.raises(BadParameter, match="prediction"):
        error_budget([Counterfactuals(0, runs(1)[0].misses, None)])
    with pytest.raises(BadParameter, match="one seed"):
        error_budget([])
