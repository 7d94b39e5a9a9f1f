"""Held-out errors: unbiased under the truth, as complete calibrations of the others find them."""

from dataclasses import replace

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.calibrate.judgement.held_out import cross_validate, held_out
from vision_robot.errors import BadParameter, TooFewViews

SIZE = (1280, 960)
NOISE = 0.2 * np.sqrt(2)
"""Per point, both axes."""


@pytest.mark.parametrize("model", CAMERAS)
def test_the_true_camera_leaves_the_noise(model):
    views = make_views(CAMERAS[model], 30, seed=1)
    error = held_out(views.camera, views.corners, views.board)
    # 30 x 170 numbers tell it to 1 % (one sigma); without the correction it would be 1.7 % less.
    assert error.rms_px == pytest.approx(NOISE, rel=0.03)
    assert error.standard_error_px == pytest.approx(0.01 * NOISE, rel=0.5)


def test_six_of_a_views_numbers_go_to_its_pose():
    """With twelve corners a quarter of the numbers is gone, and the estimate is still unbiased."""
    rng = np.random.default_rng(0)
    views = make_views(CAMERAS["brown5"], 120, seed=2)
    few = []
    for view in views.corners:
        keep = rng.choice(88, 12, replace=False)
        few.append(Corners(view.image, view.ids[keep], view.pixels[keep]))
    error = held_out(views.camera, few, views.board)
    assert (error.freedom == 18).all()
    assert error.rms_px == pytest.approx(NOISE, rel=0.05)


def test_a_wrong_camera_is_worse():
    views = make_views(CAMERAS["brown5"], 10, seed=3)
    right = held_out(views.camera, views.corners, views.board)
    wrong = held_out(replace(views.camera, distortion=(-0.2, 0, 0, 0, 0)), views.corners, views.board)
    mean, error = wrong.worse_by(right)
    assert mean > 5 * error
    assert right.worse_by(right) == (0, 0)


def test_folds_are_what_complete_calibrations_of_the_others_find():
    views = make_views(CAMERAS["brown5"], 6, seed=4)
    quick = cross_validate(views.corners, views.board, SIZE, folds=6)
    for i, view in enumerate(views.corners):
        others = calibrate([*views.corners[:i], *views.corners[i + 1 :]], views.board, SIZE)
        slow = held_out(others.camera, [view], views.board)
        assert quick.view_rms_px[i] == pytest.approx(slow.rms_px, rel=3e-3)


def test_each_view_is_held_out_once_and_costs_more_than_in_sample():
    views = make_views(CAMERAS["brown5"], 13, seed=5)
    result = calibrate(views.corners, views.board, SIZE, Settings(warp=2))
    error = cross_validate(views.corners, views.board, SIZE, Settings(warp=2), folds=4)
    assert error.images == tuple(view.image for view in views.corners)
    assert error.folds == 4
    assert error.rms_px > result.noise_px * np.sqrt(2)
    assert error.rms_px < 1.2 * NOISE


def test_the_split_follows_the_seed():
    views = make_views(CAMERAS["brown5"], 9, seed=6)
    first, again, other = (
        cross_validate(views.corners, views.board, SIZE, folds=3, seed=s) for s in (0, 0, 1)
    )
    np.testing.assert_array_equal(first.view_rms_px, again.view_rms_px)
    assert np.abs(first.view_rms_px - other.view_rms_px).max() > 0


def test_a_hopeless_view_does_not_spoil_the_others():
    views = make_views(CAMERAS["brown5"], 5, seed=7)
    clean = held_out(views.camera, views.corners, views.board)
    rng = np.random.default_rng(0)
    nonsense = Corners("nonsense", np.arange(88), rng.uniform([0, 0], SIZE, (88, 2)))
    error = held_out(views.camera, [*views.corners, nonsense], views.board)
    np.testing.assert_allclose(error.view_rms_px[:-1], clean.view_rms_px, rtol=1e-3)
    assert error.view_rms_px[-1] > 100


def test_blurred_corners_weigh_less():
    """Half of the corners ten times as noisy, and said to be: the pose follows the sharp half."""
    views = make_views(CAMERAS["brown5"], 12, seed=8, noise_px=0.1)
    rng = np.random.default_rng(0)
    told, untold = [], []
    for view in views.corners:
        blurred = np.arange(88) % 2 == 0
        pixels = view.pixels + np.where(blurred, 1.0, 0.0)[:, None] * rng.normal(size=(88, 2))
        told.append(Corners(view.image, view.ids, pixels, np.where(blurred, 1.0, 0.1)))
        untold.append(Corners(view.image, view.ids, pixels))
    assert held_out(views.camera, told, views.board).rms_px == pytest.approx(0.71 * np.sqrt(2), rel=0.1)
    sigma = [calibrate(c, views.board, SIZE, Settings(robust=False)).sigma["fx"] for c in (told, untold)]
    assert sigma[0] < 0.5 * sigma[1]


def test_too_little_is_refused():
    views = make_views(CAMERAS["brown5"], 5)
    with pytest.raises(TooFewViews, match="at least 4"):
        cross_validate(views.corners[:3], views.board, SIZE)
    with pytest.raises(BadParameter, match="folds"):
        cross_validate(views.corners, views.board, SIZE, folds=1)
    first = views.corners[0]
    with pytest.raises(BadParameter, match="four or more"):
        held_out(views.camera, [Corners("few", first.ids[:3], first.pixels[:3])], views.board)
    a, b = (held_out(views.camera, views.corners[:n], views.board) for n in (4, 5))
    with pytest.raises(BadParameter, match="same"):
        a.worse_by(b)
