"""Halves: they differ as their covariances say when the model is right, and by more when it is not."""

import numpy as np
import pytest

from tests.bent import bent
from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Settings, calibrate
from vision_robot.calibrate.judgement.halves import compare_halves
from vision_robot.errors import BadParameter, TooFewViews

SIZE = (1280, 960)


def test_under_the_right_model_the_ratio_is_one():
    """One set of views tells it to a fifth; twelve sets to 6 %."""
    found = []
    for seed in range(12):
        views = make_views(CAMERAS["brown5"], 16, seed=seed)
        found.append(compare_halves(calibrate(views.corners, views.board, SIZE), views.board, splits=4))
    assert np.sqrt(np.mean([halves.ratio**2 for halves in found])) == pytest.approx(1, abs=0.2)
    chances = np.array([halves.chance for halves in found])
    assert chances.min() > 1e-3
    assert 0.25 < chances.mean() < 0.8
    assert all("hold" in halves.sentence for halves in found if halves.honest)


def test_a_bent_board_taken_for_flat_is_noticed_and_one_that_may_bend_is_not():
    views = bent(make_views(CAMERAS["brown5"], 24, seed=1), by_m=2e-3)
    flat, free = (
        compare_halves(calibrate(views.corners, views.board, SIZE, Settings(warp=degree)), views.board)
        for degree in (0, 2)
    )
    assert not flat.honest
    assert flat.ratio > 1.8
    assert "too small" in flat.sentence
    assert free.honest
    assert free.ratio < 1.4


def test_a_row_for_each_split_the_same_for_the_same_seed():
    views = make_views(CAMERAS["fisheye"], 12, seed=1)
    result = calibrate(views.corners, views.board, SIZE, Settings(model="fisheye"))
    first, again = (compare_halves(result, views.board, splits=3, seed=5) for _ in range(2))
    assert first.found_px.shape == first.predicted_px.shape == first.ratios.shape == (3,)
    np.testing.assert_array_equal(first.found_px, again.found_px)
    assert first.chance == again.chance


def test_too_little_is_refused():
    views = make_views(CAMERAS["brown5"], 5)
    result = calibrate(views.corners, views.board, SIZE)
    with pytest.raises(TooFewViews, match="at least 6"):
        compare_halves(result, views.board)
    views = make_views(CAMERAS["brown5"], 6)
    with pytest.raises(BadParameter, match="splits"):
        compare_halves(calibrate(views.corners, views.board, SIZE), views.board, splits=0)
