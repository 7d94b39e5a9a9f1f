"""Scores and conclusions: intervals, regressions beyond noise, words no stronger than numbers."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest

from tests.evaluate.made_outcomes import outcomes
from vision_robot.errors import BadTable
from vision_robot.evaluate.baseline import regressions
from vision_robot.evaluate.conclusion import compare_methods, sentence, severity_curve
from vision_robot.evaluate.metrics import METRICS, metric_named
from vision_robot.evaluate.score import failures, read_scores, scores
from vision_robot.evaluate.sweep import Cell, Outcome

RNG = np.random.default_rng(0)
BASE = RNG.uniform(0.4, 0.6, 12)


def test_a_score_has_value_interval_and_meaning():
    (score,) = scores(outcomes({"rgb": list(BASE)}))
    assert score.value == pytest.approx(BASE.mean())
    assert score.low < score.value < score.high
    assert (score.n, score.better, score.suite, score.scene) == (12, "higher", "trackers", "speed")


def test_failures_are_not_hidden_and_give_no_score():
    broken = Outcome(Cell("trackers", "noise", "klt", 3, "m:f"), {}, "ValueError: no", 0.1, 1)
    assert scores([broken]) == []
    assert failures([broken])[0].reason == "ValueError: no"


def test_scores_are_read_back(tmp_path):
    found = scores(outcomes({"rgb": list(BASE), "klt": [0.5]}))
    rows = [{k: None if v != v else v for k, v in asdict(one).items()} for one in found]  # noqa: PLR0124
    (tmp_path / "old.json").write_text(json.dumps({"scores": rows}))
    again = read_scores(tmp_path / "old.json")
    assert again[0] == found[0]
    assert np.isnan(again[1].low)
    (tmp_path / "bad.json").write_text('{"scores": [{}]}')
    with pytest.raises(BadTable, match=r"bad\.json"):
        read_scores(tmp_path / "bad.json")


@pytest.mark.parametrize(("shift", "found"), [(-0.2, 1), (-0.005, 0), (0.2, 0)])
def test_worse_beyond_noise_is_a_regression(shift, found):
    before, after = (scores(outcomes({"rgb": list(values)})) for values in (BASE, BASE + shift))
    assert len(regressions(after, before)) == found
    lower = [replace(one, better="lower") for one in after]
    assert len(regressions(lower, before)) == (1 if shift == 0.2 else 0)


def test_one_seed_shows_no_regression():
    before, after = (scores(outcomes({"rgb": [value]})) for value in (0.9, 0.1))
    assert regressions(after, before) == []


def test_better_equivalent_and_open():
    noise = RNG.normal(0, 0.002, 12)
    close = compare_methods(
        outcomes({"rgb": list(BASE), "other": list(BASE + noise)}), "success_auc", "speed"
    )
    assert close[0].verdict == "equivalent"
    assert "are practically equal in success_auc" in sentence(close[0])
    (far,) = compare_methods(outcomes({"other": list(BASE - 0.2), "rgb": list(BASE)}), "success_auc", "speed")
    assert (far.verdict, far.better) == ("better", "rgb")
    assert far.difference.value == pytest.approx(0.2)
    assert "rgb is better than other in success_auc by 0.2" in sentence(far)
    unsure = compare_methods(
        outcomes({"rgb": list(BASE[:4]), "other": list(BASE[:4] + np.array([0.1, -0.15, 0.2, -0.05]))}),
        "success_auc",
        "speed",
    )
    assert unsure[0].verdict == "open"
    assert "not settled between" in sentence(unsure[0])
    assert "seeds would be needed" in sentence(unsure[0])


def test_lower_is_better_turns_the_winner():
    made = outcomes({"a": list(BASE), "b": list(BASE + 0.3)}, metric="centroid_error_mm")
    (found,) = compare_methods(made, "centroid_error_mm", "speed")
    assert found.better == "a"
    assert found.difference.value == pytest.approx(0.3)


def test_many_pairs_are_corrected():
    """Six methods of one kind: without correction one pair in twenty would seem to differ."""
    made = outcomes({name: list(RNG.normal(0.5, 0.1, 10)) for name in "abcdef"})
    found = compare_methods(made, "success_auc", "speed")
    assert len(found) == 15
    assert not any(one.verdict == "better" for one in found)


def test_the_curve_over_a_dial():
    made = [*outcomes({"rgb": [0.9, 0.8]}, scene="noise=0"), *outcomes({"rgb": [0.4, 0.2]}, scene="noise=1")]
    assert severity_curve(made, "success_auc", "rgb", ["noise=0", "noise=1"]).tolist() == [
        [0.9, 0.4],
        [0.8, 0.2],
    ]


def test_every_metric_says_what_it_means():
    assert {metric.better for metric in METRICS.values()} == {"higher", "lower"}
    assert all(metric.meaning for metric in METRICS.values())
    assert metric_named("of_a_plug_in").better == "lower"
    assert METRICS["fps"].zone_at(200) == pytest.approx(20)
