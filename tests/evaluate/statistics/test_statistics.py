"""Statistics: intervals that hold the truth as often as they say, tests that keep their level."""

import numpy as np
import pytest
from scipy import stats

from vision_robot.errors import BadParameter
from vision_robot.evaluate.statistics import (
    breakdown_point,
    clustered_interval,
    compare_pairs,
    holm,
    rank_methods,
    seeds_needed,
    wilson_interval,
)


def coverage(clusters: int, draw) -> float:
    """How often the 95 % interval of the mean holds the true mean, 0."""
    rng, held, runs = np.random.default_rng(clusters), 0, 300
    for _ in range(runs):
        found = clustered_interval(draw(rng, clusters), np.arange(clusters))
        held += found.low <= 0 <= found.high
    return held / runs


@pytest.mark.parametrize("clusters", [4, 12, 30])
def test_intervals_hold_the_truth(clusters):
    assert 0.90 <= coverage(clusters, lambda rng, n: rng.normal(size=n)) <= 0.99


def test_intervals_of_a_skewed_quantity():
    assert coverage(30, lambda rng, n: rng.exponential(size=n) - 1) >= 0.88


def test_values_of_one_cluster_are_one_observation():
    """A hundred copies of each of 10 values say no more than the ten."""
    values = np.random.default_rng(0).normal(size=10)
    once = clustered_interval(values, np.arange(10))
    often = clustered_interval(np.repeat(values, 100), np.repeat(np.arange(10), 100))
    assert (often.low, often.high, often.n) == pytest.approx((once.low, once.high, 10))


def test_too_few_for_an_interval():
    assert np.isnan(clustered_interval(np.array([1.0]), np.array([0])).low)
    assert clustered_interval(np.array([np.nan]), np.array([0])).n == 0


@pytest.mark.parametrize(("successes", "trials"), [(0, 10), (3, 10), (10, 10), (437, 500)])
def test_wilson_is_scipys(successes, trials):
    theirs = stats.binomtest(successes, trials).proportion_ci(method="wilson")
    ours = wilson_interval(successes, trials)
    assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=1e-12)


def test_wilson_refuses_more_successes_than_trials():
    with pytest.raises(BadParameter, match="successes"):
        wilson_interval(3, 2)


def test_sign_flips_are_scipys_permutation_test():
    off = np.array([0.3, 1.2, -0.4, 0.8, 0.9, -0.1, 0.5])
    theirs = stats.permutation_test((off,), np.sum, permutation_type="samples", n_resamples=10_000)
    assert compare_pairs(off, 0 * off, np.arange(7)).p == pytest.approx(theirs.pvalue)


def test_the_test_keeps_its_level():
    """Equal methods: p under 0.05 in about 5 of 100 runs."""
    rng = np.random.default_rng(3)
    seeds = np.arange(20)
    small = [compare_pairs(rng.normal(size=20), rng.normal(size=20), seeds).p < 0.05 for _ in range(200)]
    assert 0.01 <= np.mean(small) <= 0.10


def test_equivalence_needs_evidence():
    rng = np.random.default_rng(5)
    base = rng.normal(size=30)
    close = base + rng.normal(0, 0.01, 30)
    assert compare_pairs(base, close, np.arange(30), zone=0.05).equivalent
    assert not compare_pairs(base, close, np.arange(30)).equivalent  # no zone, nothing is equivalent
    assert not compare_pairs(base[:2], close[::-1][:2], np.arange(2), zone=0.05).equivalent


def test_holm_by_hand():
    assert np.allclose(holm([0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02])
    assert np.allclose(holm([0.9, 0.8]), [1, 1])


def test_seeds_needed_finds_the_difference():
    """With the number it names, a t-test finds the difference in about 80 of 100 runs."""
    rng = np.random.default_rng(7)
    n = seeds_needed(rng.normal(size=4000), smallest=0.5)
    assert n is not None
    critical = stats.t.ppf(0.975, n - 1)
    drawn = rng.normal(0.5, 1, size=(500, n))
    found = np.abs(drawn.mean(axis=1)) * np.sqrt(n) / drawn.std(axis=1, ddof=1) > critical
    assert 0.74 <= np.mean(found) <= 0.87
    assert seeds_needed(np.array([1.0]), smallest=0.5) is None


def test_a_clear_order_has_a_winner_and_a_tie_has_none():
    rng = np.random.default_rng(1)
    noise = rng.normal(0, 0.05, size=(20, 3))
    ranking = rank_methods(["c", "a", "b"], noise + np.array([0.2, 0.9, 0.5]), np.arange(20))
    assert ranking.methods == ("a", "b", "c")
    assert ranking.winner == "a"
    assert ranking.groups == ((0, 0), (1, 1), (2, 2))
    tied = rank_methods(["c", "a", "b"], noise + np.array([0.2, 0.9, 0.9]), np.arange(20))
    assert tied.winner is None
    assert (0, 1) in tied.groups
    down = rank_methods(
        ["c", "a", "b"], noise + np.array([0.2, 0.9, 0.5]), np.arange(20), higher_is_better=False
    )
    assert down.winner == "c"


def test_breakdown_between_two_severities():
    scores = np.array([[1.0, 0.9, 0.7, 0.3], [1.0, 0.9, 0.7, 0.3]])
    found = breakdown_point(np.array([0.0, 1, 2, 3]), scores)
    assert found.severity == pytest.approx(2.5)
    assert found.low == found.high == pytest.approx(2.5)
    never = breakdown_point(np.array([0.0, 1]), np.ones((3, 2)))
    assert np.isinf(never.severity)
    at_once = breakdown_point(np.array([0.0, 1]), np.zeros((3, 2)))
    assert at_once.severity == 0


def test_one_lucky_score_far_out_does_not_move_the_breakdown():
    steady = breakdown_point(np.arange(5.0), np.array([[1, 0.8, 0.4, 0.1, 0.1]]))
    lucky = breakdown_point(np.arange(5.0), np.array([[1, 0.8, 0.4, 0.1, 0.4]]))
    assert lucky.severity == pytest.approx(steady.severity)
