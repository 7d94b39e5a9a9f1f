"""The page of episodes: failures first, what is asked and found, in one file that fetches nothing."""

from dataclasses import replace

import numpy as np

from tests.picked import WORLD, episode
from tests.picked import budget_runs as runs
from vision_robot.evaluate.error_budget import error_budget
from vision_robot.pick.episode import Look, Miss
from vision_robot.pick.episodes import Plan
from vision_robot.pick.film import Still
from vision_robot.report.page import Table, render_page
from vision_robot.report.pick import PickStory, pick_page, picks_piece
from vision_robot.report.pick_budget import bars_mm2

RNG = np.random.default_rng(2)
PICTURE = np.full((60, 80, 3), 128, dtype=np.uint8)


def good(seed, loop=False):
    x, y, turn = RNG.uniform(-0.1, 0.1, 3)
    looks = tuple(Look(k / 10, 0.01 / (k + 1), 0.1, 0.011 / (k + 1)) for k in range(4)) if loop else ()
    return replace(
        episode(seed, x, y, 30 * turn, off=tuple(RNG.normal(0, 0.0005, 2))),
        reached=True,
        gripped=True,
        lifted=True,
        placed=True,
        placing=Miss(0.0002, 0.0003, 0.0, 0.001),
        seconds=8.2,
        looks=1 + len(looks),
        course=looks,
    )


def test_a_page_with_everything():
    lost = replace(episode(7, 0.05, 0.02, 0.3, off=(0.02, 0.0)), failure=None, seconds=5.0)
    blind = replace(episode(8), closing=None, seen_error_m=np.nan, failure="tracker rgb does not see <rod>")
    story = PickStory(
        Plan(options={"color": "red"}, loop="look-move-look"),
        WORLD,
        ("camera-rotation=1deg",),
        (*(good(k, loop=True) for k in range(6)), lost, blind),
        error_budget(runs(12)),
        {0: [Still("seen", 0.3, ("seen 0.4 mm off",), PICTURE)], 7: [Still("close", 3.0, (), PICTURE)] * 2},
    )
    html = render_page(pick_page(story, command="vr pick --report pick.html", seed=0))
    titles = ["What failed", "How far it got", "How well it hit", "Where it is worse", "Closing the loop",
              "Where the millimetres come from", "An episode", "What was asked"]  # fmt: skip
    places = [html.index(f"<h2>{title}") for title in titles]
    assert places == sorted(places)
    assert "&lt;rod&gt;" in html
    assert "the label on the hand was hidden" in html  # of the one that saw the thing and closed no loop
    assert "camera-rotation=1deg" in html
    assert "data:image/jpeg" in html
    assert "ISO 9283" in html
    assert "vr pick --report pick.html" in html
    assert "http" not in html.split("</style>")[1]


def test_a_page_of_nothing_but_failures():
    some = tuple(replace(episode(k), closing=None, seen_error_m=np.nan, failure="not seen") for k in range(3))
    html = render_page(pick_page(PickStory(Plan(), WORLD, (), some)))
    assert "What failed" in html
    assert "How well it hit" not in html
    assert "never came so far" in html
    assert "nan" not in html.split("</style>")[1].lower().replace("finance", "")


def test_the_waterfall_adds_up():
    budget = error_budget(runs(12))
    measured = sum(value for _, value, _ in bars_mm2(budget))
    foretold = sum(value for _, _, value in bars_mm2(budget))
    assert np.isclose(measured, 1e6 * budget.total_m.value**2)
    assert np.isclose(foretold, 1e6 * budget.predicted_m**2)


def test_conditions_side_by_side():
    well, astray = (good(0), good(1)), tuple(episode(k, off=(0.013, 0.001 * k)) for k in range(2))
    stills = {0: [Still("seen", 0.3, (), PICTURE)]}
    stories = {
        "as it was": PickStory(Plan(), WORLD, (), well, None, stills),
        "knocked": PickStory(Plan(), WORLD, (), astray),
    }
    table = picks_piece(stories)[0]
    assert isinstance(table, Table)
    assert [row[:4] for row in table.rows] == [("as it was", "2", "2", "2"), ("knocked", "2", "0", "0")]
