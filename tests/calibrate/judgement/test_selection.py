"""Selection: the lens and board that made the corners, not the ones with the least rms."""

import numpy as np
import pytest

from tests.bent import bent
from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Corners, Settings
from vision_robot.calibrate.judgement.selection import every_candidate, select
from vision_robot.errors import BadParameter, DegenerateViews, NoConvergence, TooFewViews

SIZE = (1280, 960)
LENSES = every_candidate(degrees=(0,))
BOARDS = [Settings(model=model, warp=degree) for model in ("brown5", "brown8") for degree in (0, 2)]


@pytest.mark.parametrize("model", ["pinhole", "brown5", "fisheye"])
@pytest.mark.parametrize("seed", [0, 1])
def test_the_lens_that_made_the_corners(model, seed):
    views = make_views(CAMERAS[model], 14, seed=seed)
    found = select(views.corners, views.board, SIZE, LENSES)
    assert found.chosen.model == model
    # The richest fits the corners best and is not taken for it.
    assert np.nanmin(found.rms_px) < found.rms_px[found.chosen_index]
    assert np.nanmin(found.exceeds) == found.exceeds[found.best_index] == 0


@pytest.mark.parametrize("bend_m", [0, 1e-3])
def test_a_bent_board_is_told_from_a_lens(bend_m):
    views = make_views(CAMERAS["brown5"], 14, seed=1)
    views = bent(views, by_m=bend_m) if bend_m else views
    found = select(views.corners, views.board, SIZE, BOARDS, folds=7)
    assert (found.chosen.model, found.chosen.warp) == ("brown5", 2 if bend_m else 0)


def test_wrong_corners_do_not_choose():
    views = make_views(CAMERAS["brown5"], 12, seed=2)
    spoiled = views.corners[3]
    pixels = spoiled.pixels.copy()
    pixels[[5, 40]] += [[12.0, -4.0], [3.0, 9.0]]
    views.corners[3] = Corners(spoiled.image, spoiled.ids, pixels)
    found = select(views.corners, views.board, SIZE, LENSES)
    assert found.chosen.model == "brown5"
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
    """Fifth degree is not looked at unless third helps."""
    views = make_views(CAMERAS["pinhole"], 10, seed=4)
    x = (views.board[:, 0] - 0.15) / 0.15
    fold = 1e-3 * (16 * x**5 - 20 * x**3 + 5 * x) + 1e-3 * (4 * x**3 - 3 * x)
    pixels = views.camera.project(views.cam_from_board.apply(views.board + np.outer(fold, [0, 0, 1])))
    pixels += 0.1 * np.random.default_rng(0).normal(size=pixels.shape)
    corners = [Corners(v.image, v.ids, p) for v, p in zip(views.corners, pixels, strict=True)]
    ladder = [Settings(model="pinhole", warp=degree) for degree in range(7)]
    assert select(corners, views.board, SIZE, ladder, folds=4).chosen.warp == 5
    flat = select(views.corners, views.board, SIZE, ladder, folds=4)
    assert max(settings.warp for settings in flat.settings) == 4


def test_nothing_to_choose_is_refused():
    views = make_views(CAMERAS["brown5"], 6)
    with pytest.raises(BadParameter, match="candidates"):
        select(views.corners, views.board, SIZE, ())
    with pytest.raises(TooFewViews):
        select(views.corners[:2], views.board, SIZE, LENSES)
    parallel = make_views(CAMERAS["brown5"], 8, tilt=0.0)
    with pytest.raises((DegenerateViews, NoConvergence)):
        select(parallel.corners, parallel.board, SIZE, LENSES)
