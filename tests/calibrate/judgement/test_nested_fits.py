"""Richer neighbours of a calibration: nested, needed only where they are, and views that agree or not."""

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Settings, calibrate
from vision_robot.calibrate.judgement.nested_fits import NestedFits

SIZE = (1280, 960)


def fits(views, **options):
    return NestedFits(calibrate(views.corners, views.board, SIZE, Settings(**options)), views.board)


def test_the_richer_the_lower_the_cost_and_noise_asks_for_neither():
    nested = fits(make_views(CAMERAS["brown5"], 15, seed=2))
    found = [nested.fit(richer_lens=a, richer_board=b) for a in (False, True) for b in (False, True)]
    own, board, lens, both = (fit.end.equations.cost for fit in found if fit)
    assert both < min(lens, board)
    assert max(lens, board) < own
    reference, needs_lens, needs_board = nested.reference()
    assert (needs_lens, needs_board) == (False, False)
    assert reference is found[0]


@pytest.mark.parametrize(
    ("model", "fixed", "richer"),
    [
        ("pinhole", {}, "brown5"),
        ("brown5", {}, "brown8"),
        ("brown5", {"k3": 0.0}, "brown5"),
        ("brown8", {}, None),
    ],
)
def test_the_next_richer_lens(model, fixed, richer):
    views = make_views(CAMERAS["pinhole"], 12, seed=1)
    found = fits(views, model=model, fixed=fixed).fit(richer_lens=True, richer_board=False)
    assert (found and found.end.state.camera.model) == richer


def test_under_white_noise_the_views_tell_the_propagated_covariance():
    """CR2 is unbiased: over many calibrations its trace, in units of the propagated covariance, is one."""
    ratios = []
    for seed in range(12):
        nested = fits(make_views(CAMERAS["pinhole"], 8, seed=seed), model="pinhole")
        fit = nested.fit(richer_lens=False, richer_board=False)
        assert fit
        _, between = fit.sandwich
        ratios.append(np.trace(fit.information @ between) / (fit.variance * len(between)))
    scatter = np.std(ratios) / np.sqrt(len(ratios))
    assert np.mean(ratios) == pytest.approx(1, abs=3 * scatter)
    assert scatter < 0.15
