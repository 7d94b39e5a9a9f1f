"""The page of a benchmark: says who is ahead only when it is so, and hides no failure."""

import re

import numpy as np

from tests.evaluate.made_outcomes import outcomes
from vision_robot.evaluate.answer import ranking_of
from vision_robot.evaluate.dial import dials_of, measured
from vision_robot.evaluate.sweep import Cell, Outcome
from vision_robot.report.benchmark import benchmark_page
from vision_robot.report.page import render_page

LEVELS = {"rgb": 0.9, "background": 0.7, "optical-flow": 0.7}


def made(seeds: int = 12) -> list[Outcome]:
    """Three methods on two plain scenes and one dial of four severities."""
    rng, found = np.random.default_rng(0), list[Outcome]()
    scenes = {"single-rod": 0.0, "clutter": 0.1, **{f"noise={s:g}": 0.15 * s for s in range(4)}}
    for scene, loss in scenes.items():
        figures = {name: list(level - loss + rng.normal(0, 0.03, seeds)) for name, level in LEVELS.items()}
        found += outcomes(figures, "hota", scene)
    return found


def test_a_clear_winner_is_named_and_a_tie_is_not():
    text = render_page(benchmark_page("trackers", made(), metric="hota"))
    assert re.search(r"better in hota</dt>\s*<dd class=.value.>rgb<", text)
    assert "rgb is better in hota than every other method over 6 scenes" in text
    rest = [one for one in made() if one.cell.method != "rgb"]
    text = render_page(benchmark_page("trackers", rest, metric="hota"))
    assert "No method is better in hota than every other" in text
    assert re.search(r"better in hota</dt>\s*<dd class=.value.>nobody<", text)


def test_dials_are_found_and_breakdowns_shown():
    found = made()
    (dial,) = dials_of(list(dict.fromkeys(one.cell.scene for one in found)))
    assert (dial.name, dial.severities) == ("noise", (0, 1, 2, 3))
    _, scores, breaks = measured(dial, found, "hota", "background")  # type: ignore[misc]
    assert scores.shape == (12, 4)
    assert breaks.severity == np.clip(breaks.severity, 1, 1.7)  # 0.7 - 0.15 s = 0.5 at 1.33
    assert "Where methods break" in render_page(benchmark_page("trackers", found, metric="hota"))


def test_a_dial_of_errors_breaks_where_they_rise():
    rng, found = np.random.default_rng(0), list[Outcome]()
    for s in range(5):
        figures = {"ours": list(0.3 * s + rng.normal(0, 0.01, 10)), "theirs": list(2 * s + np.zeros(10))}
        found += outcomes(figures, "flow_epe_px", f"speed={s:g}")
    (dial,) = dials_of([f"speed={s:g}" for s in range(5)])
    _, _, ours = measured(dial, found, "flow_epe_px", "ours", threshold=1.0)  # type: ignore[misc]
    assert ours.severity == np.clip(ours.severity, 3.2, 3.5)  # 0.3 s = 1 at 3.33
    _, _, theirs = measured(dial, found, "flow_epe_px", "theirs", threshold=1.0)  # type: ignore[misc]
    assert (theirs.severity, theirs.low, theirs.high) == (0.5, 0.5, 0.5)
    cell = found[-1].cell
    failed = [Outcome(cell, {}, "it hung", 1, 1) if one.cell == cell else one for one in found]
    _, scores, theirs = measured(dial, failed, "flow_epe_px", "theirs", threshold=9)  # type: ignore[misc]
    assert np.isinf(scores[-1, -1])
    assert theirs.severity == 4
    text = render_page(benchmark_page("flow", failed, metric="flow_epe_px", threshold=1.0))
    assert "mean flow_epe_px rises over 1.00" in text
    assert "it hung" in text


def test_failures_of_one_reason_are_one_line():
    found = [
        Outcome(Cell("s", f"scene {k % 3}", "klt", k, "m:f"), {}, "ValueError: no <b>", 0.1, 1)
        for k in range(9)
    ]
    text = render_page(benchmark_page("s", [*made(3), *found], metric="hota"))
    assert text.count("ValueError: no &lt;b&gt;") == 1
    assert "scene 0, scene 1 and scene 2" in text


def test_nothing_but_failures_makes_a_page():
    one = Outcome(Cell("s", "scene", "klt", 0, "m:f"), {}, "ValueError: no", 0.1, 1)
    assert "No method has a figure" in render_page(benchmark_page("s", [one], metric="hota"))


def test_a_failure_is_told_and_ranks_last():
    found = made(6)
    cell = found[0].cell
    found[0] = Outcome(cell, {}, "ValueError: <no> frames", 0.1, 1)
    text = render_page(benchmark_page("trackers", found, metric="hota"))
    assert "ValueError: &lt;no&gt; frames" in text
    whole = ranking_of(made(6), "hota", list(LEVELS)).ranks[0]
    assert ranking_of(found, "hota", list(LEVELS)).ranks[0] > whole


def test_one_method_on_one_seed_makes_a_page():
    one = [Outcome(Cell("ik", "column", "closed-form", 0, "m:f"), {"ik_success": 1.0}, None, 0.1, 1)]
    assert "closed-form" in render_page(benchmark_page("ik", one, metric="ik_success"))
