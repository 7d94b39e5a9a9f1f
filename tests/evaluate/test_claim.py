"""Claims: held, refuted or left open by made outcomes, and the words for it."""

import pytest

from tests.evaluate.made_outcomes import outcomes
from vision_robot.evaluate.claim import Claim, claim_words, findings
from vision_robot.evaluate.sweep import Cell, Outcome

CLAIM = Claim("the text", "rgb", ("flow", "background"))
SEEDS = 8
NEARLY_UP = [0.9 + 0.001 * (k % 3) for k in range(SEEDS)]
UP, MIDDLE, DOWN = ([base + 0.001 * k for k in range(SEEDS)] for base in (0.9, 0.6, 0.3))


def made(scene: str, rgb: list[float], flow: list[float], background: list[float]) -> list[Outcome]:
    return outcomes({"rgb": rgb, "flow": flow, "background": background}, "hota", scene)


@pytest.mark.parametrize(
    ("rgb", "flow", "background", "verdict"),
    [
        (UP, MIDDLE, DOWN, "holds"),
        (MIDDLE, UP, DOWN, "fails"),
        (UP, NEARLY_UP, DOWN, "equal"),
        (UP, UP, DOWN, "equal"),
        ([0.2, 1.0] * 4, [1.0, 0.2] * 4, DOWN, "open"),
    ],
)
def test_verdicts(rgb, flow, background, verdict):
    (found,) = findings(made("noise=1", rgb, flow, background), "hota", CLAIM)
    assert found.verdict("rgb") == verdict


def test_two_seeds_settle_nothing():
    (found,) = findings(made("noise=1", UP[:2], MIDDLE[:2], DOWN[:2]), "hota", CLAIM)
    assert found.verdict("rgb") == "open"


def test_a_method_that_fails_where_others_do_not_holds_no_claim():
    lost = Outcome(Cell("trackers", "noise=1", "rgb", 99, "m:f"), {}, "Crash", 0.1, 1)
    others = [
        Outcome(Cell("trackers", "noise=1", name, 99, "m:f"), {"hota": 0.1}, None, 0.1, 1)
        for name in CLAIM.rivals
    ]
    (found,) = findings([*made("noise=1", UP, MIDDLE, DOWN), lost, *others], "hota", CLAIM)
    assert found.failed == 1
    assert found.verdict("rgb") == "open"


def test_axes_pool_their_severities_and_words_say_no_more():
    some = [
        *made("noise=0", UP, MIDDLE, DOWN),
        *made("noise=1", UP, MIDDLE, DOWN),
        *made("colour=1", DOWN, UP, UP),
        *made("usual", UP, UP, MIDDLE),
    ]
    whole, *axes = findings(some, "hota", CLAIM)
    assert whole.axis == ""
    assert [one.axis for one in axes] == ["noise", "colour", "usual"]
    first, *rest = claim_words([whole, *axes], CLAIM)
    assert first.startswith("The text says that rgb is better than flow and background. In hota, over all")
    assert rest[0] == "It holds on noise (rgb 0.90, flow 0.60, background 0.30)."
    assert rest[1].startswith("It does not hold on colour, where flow and background are better")
    assert rest[2].startswith("No difference that matters on usual")
    assert claim_words([], CLAIM) == []
