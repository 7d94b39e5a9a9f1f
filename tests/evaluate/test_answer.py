"""Conclusions are never stronger than their numbers: laws of the words, on figures drawn by chance."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.evaluate.made_outcomes import outcomes
from vision_robot.evaluate.answer import answer, answer_words
from vision_robot.evaluate.conclusion import LEVEL, compare_methods, needed_words, sentence
from vision_robot.evaluate.sweep import Cell, Outcome

METRIC = "success_auc"


@st.composite
def tables(draw) -> dict[str, list[float]]:
    """Figures of two to five methods on one to fourteen seeds: clear, close and noisy differences."""
    seeds = draw(st.integers(1, 14))
    rng = np.random.default_rng(draw(st.integers(0, 2**31)))
    scene = rng.normal(0, 0.1, seeds)
    table = {}
    for name in "abcde"[: draw(st.integers(2, 5))]:
        level, noise = draw(st.sampled_from((0.3, 0.5, 0.501, 0.7))), draw(st.sampled_from((0, 1e-3, 0.05)))
        table[name] = list(level + scene + rng.normal(0, noise, seeds))
    return table


def text_of(found) -> str:
    return " ".join(text for _, text in answer_words(found))


@given(tables())
def test_nobody_wins_without_significance_against_everybody(table):
    made = outcomes(table, METRIC)
    found = answer(made, METRIC)
    assert found is not None
    pairs = compare_methods(made, METRIC)
    if found.winner:
        mine = [one for one in pairs if found.winner in (one.better, one.worse)]
        assert len(mine) == len(table) - 1
        assert all(one.better == found.winner and one.p < LEVEL and not one.equivalent for one in mine)
        assert f"{found.winner} is better in {METRIC} than every other method" in text_of(found)
    else:
        assert "No method is better" in text_of(found)
        assert "than every other method" not in text_of(found)


@given(tables())
def test_equal_only_by_the_test_for_it_and_open_only_with_what_would_settle_it(table):
    for one in compare_methods(outcomes(table, METRIC), METRIC):
        text = sentence(one)
        assert ("the same" in text) == (one.verdict == "same") == (table[one.better] == table[one.worse])
        assert (
            ("practically equal" in text)
            == (one.verdict == "equivalent")
            == (one.equivalent and not one.same)
        )
        assert ("is better than" in text) == (one.p < LEVEL and not one.equivalent)
        assert ("not settled" in text) == (one.verdict == "open")
        if one.verdict == "equivalent":
            assert abs(one.difference.value) < one.zone
        if one.verdict == "open":
            seeds = int(re.findall(r"(\d+) seeds", needed_words(one))[0])
            assert seeds > one.difference.n
            assert f"{seeds} seeds would be needed" in text


@given(tables())
def test_every_method_stands_under_exactly_one_heading(table):
    found = answer(outcomes(table, METRIC), METRIC)
    assert found is not None
    names = sorted(one.method for one in found.standings)
    assert names == sorted(table)
    if not found.winner:
        first, *others = found.standings
        for one in others:
            assert text_of(found).count(f" {one.method}") >= 1 or one.verdict == "apart"
        assert first.verdict == "first"


@given(tables(), st.permutations("abcde"))
def test_names_and_their_order_change_nothing(table, names):
    renamed = {names["abcde".index(name)]: values for name, values in reversed(table.items())}
    before = {frozenset((o.better, o.worse)): o.verdict for o in compare_methods(outcomes(table), METRIC)}
    after = {frozenset((o.better, o.worse)): o.verdict for o in compare_methods(outcomes(renamed), METRIC)}
    for pair, verdict in before.items():
        assert after[frozenset(names["abcde".index(name)] for name in pair)] == verdict


@given(tables(), st.floats(-0.2, 0.2))
def test_what_all_have_in_common_changes_no_verdict(table, shift):
    moved = {name: [value + shift for value in values] for name, values in table.items()}
    for one, other in zip(
        compare_methods(outcomes(table), METRIC), compare_methods(outcomes(moved), METRIC), strict=True
    ):
        assert (one.p, one.seeds_needed is None) == pytest.approx((other.p, other.seeds_needed is None))


@given(st.integers(2, 5), st.floats(0.01, 0.5))
def test_one_seed_settles_nothing(count, step):
    table = {name: [0.2 + step * k] for k, name in enumerate("abcde"[:count])}
    found = answer(outcomes(table, METRIC), METRIC)
    assert found is not None
    assert found.winner is None
    assert {one.verdict for one in found.standings[1:]} == {"open"}
    assert "at least" in text_of(found)


def test_too_few_seeds_for_so_many_pairs_say_so():
    rng = np.random.default_rng(0)
    table = {name: list(0.1 * k + rng.normal(0, 1e-3, 6)) for k, name in enumerate("abcde")}
    (one, *_) = compare_methods(outcomes(table), METRIC)
    assert one.verdict == "open"  # ten pairs need nine seeds, however clear the difference
    assert one.least_seeds == 9
    assert one.seeds_needed is not None
    assert one.seeds_needed >= 9


def with_failures(table: dict[str, list[float]], failed: dict[str, int]) -> list[Outcome]:
    made = []
    for outcome in outcomes(table, METRIC):
        cell = outcome.cell
        bad = cell.seed < failed.get(cell.method, 0)
        made.append(Outcome(cell, {}, "ValueError: no", 0.1, 1) if bad else outcome)
    return made


def test_what_never_differed_is_said_so_and_not_called_equal():
    """A thousand goals reached by both leave room for more than the zone: only what was seen is told."""
    table = {"a": [1.0] * 12, "b": [1.0] * 12, "c": [1.0] * 11 + [0.99]}
    found = answer(outcomes(table, "ik_success"), "ik_success")
    assert found is not None
    assert found.winner is None
    assert "The same as a on every scene and seed: b." in text_of(found)
    assert "Practically equal" not in text_of(found)


def test_who_fails_oftener_than_another_wins_nothing():
    rng = np.random.default_rng(1)
    table = {name: list(level + rng.normal(0, 0.01, 14)) for name, level in (("a", 0.9), ("b", 0.5))}
    whole = answer(outcomes(table, METRIC), METRIC)
    assert whole is not None
    assert whole.winner == "a"
    found = answer(with_failures(table, {"a": 2}), METRIC)
    assert found is not None
    assert found.winner is None
    assert "a failed on 2 scenes and seeds" in text_of(found)
    (pair,) = compare_methods(with_failures(table, {"a": 2}), METRIC)
    assert pair.failed == 2
    assert "2 runs in which one of them failed do not count here" in sentence(pair)


def test_a_better_rank_with_a_worse_mean_is_no_win():
    """a is a little better nearly everywhere and terribly wrong on one scene of every seed."""
    rng = np.random.default_rng(2)
    made = []
    for scene in range(5):
        lag = 0.9 if scene == 0 else -0.01
        values = list(0.9 + rng.normal(0, 1e-3, 12))
        table = {"a": [v - max(lag, 0) for v in values], "b": [v + min(lag, 0) for v in values]}
        made += outcomes(table, METRIC, f"scene {scene}")
    found = answer(made, METRIC)
    assert found is not None
    assert found.standings[0].method == "a"
    assert found.winner is None
    assert [one.verdict for one in found.standings] == ["first", "ahead"]
    assert "Better in the mean than a, though lower in rank: b" in text_of(found)


def test_times_that_were_measured_apart_do_not_count_as_failures():
    table = {"a": [0.9] * 12, "b": [0.5 + 0.01 * k for k in range(12)]}
    times = [
        Outcome(Cell("s", "speed", name, 0, "m:f", {"timed": 1}, True), {"fps": 9.0}, None, 0.1, 1)
        for name in "ab"
    ]
    broken = Outcome(Cell("s", "speed", "a", 1, "m:f", {"timed": 1}, True), {}, "OSError: no", 0.1, 1)
    found = answer([*times, broken, *outcomes(table, METRIC), broken, *times], METRIC)
    assert found is not None
    assert (found.winner, found.standings[0].failed) == ("a", 0)


def test_scenes_of_one_seed_are_one_observation():
    """Forty scenes of three seeds are three observations: no test can be settled by them."""
    made = []
    for scene in range(40):
        made += outcomes({"a": [0.9, 0.9, 0.9], "b": [0.5, 0.5, 0.5]}, METRIC, f"scene {scene}")
    (pair,) = compare_methods(made, METRIC)
    assert pair.difference.n == 3
    assert pair.verdict == "open"


def test_nothing_to_say_of_nothing():
    assert answer([], METRIC) is None
    found = answer(outcomes({"a": [0.5]}, METRIC), METRIC)
    assert found is not None
    assert found.winner is None
    assert "nothing to compare" in text_of(found)
