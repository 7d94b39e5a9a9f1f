"""Selection: the lens and board that made the corners, not the ones with the least rms."""

import numpy as np
import pytest

from tests.bent import bent
from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Corners, Settings
from vision_robot.calibrate.selection import every_candidate, select
from vision_robot.errors import BadParameter, DegenerateViews, NoConvergence, TooFewViews

SIZE = (1280, 960)
CANDIDATES = every_candidate(degrees=(0, 2))


@pytest.mark.parametrize("model", ["pinhole", "brown5", "fisheye"])
@pytest.mark.parametrize("seed", [0, 1])
def test_the_lens_that_made_the_corners_and_a_flat_board(model, seed):
    views = make_views(CAMERAS[model], 14, seed=seed)
    found = select(views.corners, views.board, SIZE, CANDIDATES, folds=5)
    assert (found.chosen.model, found.chosen.warp) == (model, 0)
    # The richest fits the corners best and is not taken for it.
    assert np.nanmin(found.rms_px) < found.rms_px[found.chosen_index]
    assert np.nanmin(found.exceeds) == found.exceeds[found.best_index] == 0


@pytest.mark.parametrize("seed", [0, 1])
def test_a_bent_board_is_told_from_a_lens(seed):
    views = bent(make_views(CAMERAS["brown5"], 14, seed=seed), by_m=1e-3)
    found = select(views.corners, views.board, SIZE, CANDIDATES, folds=5)
    assert (found.chosen.model, found.chosen.warp) == ("brown5", 2)


def test_wrong_corners_do_not_choose():
    views = make_views(CAMERAS["brown5"], 12, seed=2)
    spoiled = views.corners[3]
    pixels = spoiled.pixels.copy()
    pixels[[5, 40]] += [[12.0, -4.0], [3.0, 9.0]]
    views.corners[3] = Corners(spoiled.image, spoiled.ids, pixels)
    found = select(views.corners, views.board, SIZE, CANDIDATES, folds=4)
    assert (found.chosen.model, found.chosen.warp) == ("brown5", 0)
    assert found.rms_px[found.chosen_index] < 0.3


def test_a_candidate_that_fails_is_kept_with_the_reason():
    views = make_views(CAMERAS["brown5"], 8, seed=3)
    absurd = Settings(model="pinhole", fixed={"fx": 5.0})
    found = select(views.corners, views.board, SIZE, (absurd, Settings()), folds=4, exhaustive=True)
    assert found.chosen == Settings()
    row = found.settings.index(absurd)
    assert np.isnan(found.held_out_px[row])
    assert len(found.why[row]) > 20


def test_more_of_the_board_is_tried_as_long_as_it_helps():
    """A fold of fifth degree in the board brings in degrees that are not looked at otherwise."""
    views = make_views(CAMERAS["pinhole"], 12, seed=4)
    x = (views.board[:, 0] - 0.15) / 0.15
    real = views.board + np.stack([0 * x, 0 * x, 2e-3 * (16 * x**5 - 20 * x**3 + 5 * x)], axis=-1)
    pixels = views.camera.project(views.cam_from_board.apply(real))
    pixels += 0.2 * np.random.default_rng(0).normal(size=pixels.shape)
    corners = [Corners(v.image, v.ids, p) for v, p in zip(views.corners, pixels, strict=True)]
    ladder = [Settings(model="pinhole", warp=degree) for degree in range(7)]
    found = select(corners, views.board, SIZE, ladder, folds=4)
    assert found.chosen.warp == 5
    flat = make_views(CAMERAS["pinhole"], 12, seed=4)
    assert max(s.warp for s in select(flat.corners, views.board, SIZE, ladder, folds=4).settings) == 4


def test_nothing_to_choose_is_refused():
    views = make_views(CAMERAS["brown5"], 6)
    with pytest.raises(BadParameter, match="candidates"):
        select(views.corners, views.board, SIZE, ())
    with pytest.raises(TooFewViews):
        select(views.corners[:2], views.board, SIZE, CANDIDATES)
    parallel = make_views(CAMERAS["brown5"], 8, tilt=0.0)
    with pytest.raises((DegenerateViews, NoConvergence)):
        select(parallel.corners, parallel.board, SIZE, CANDIDATES)
