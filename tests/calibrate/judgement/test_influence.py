"""Influence: as complete calibrations without the view find it, and the views to blame are named."""

from dataclasses import replace

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.calibrate.judgement.influence import influence
from vision_robot.calibrate.judgement.picture import Picture

SIZE = (1280, 960)


@pytest.mark.parametrize(("warp", "within"), [(0, 0.1), (2, 0.15)])
def test_one_step_is_as_good_as_a_complete_calibration(warp, within):
    views = make_views(CAMERAS["brown5"], 9, seed=2)
    settings = Settings(warp=warp)
    result = calibrate(views.corners, views.board, SIZE, settings)
    found = influence(result, views.board)
    picture = Picture.of(result.camera)
    for i in range(9):
        others = calibrate([*views.corners[:i], *views.corners[i + 1 :]], views.board, SIZE, settings)
        moved = np.sqrt(picture.mean_square(picture.difference(others.camera)))
        assert found.moved_px[i] == pytest.approx(moved, rel=within, abs=0.02 * found.sigma_px)
        change = others.camera.parameters - result.camera.parameters
        off = np.abs(found.change[i, :10] - change)[result.free] / result.covariance.sigma[result.free]
        assert off.max() < 0.1 * (1 + found.cook[i])


def test_under_the_right_model_views_move_it_as_far_as_predicted():
    ratios = []
    for seed in range(6):
        views = make_views(CAMERAS["brown5"], 16, seed=seed)
        found = influence(calibrate(views.corners, views.board, SIZE), views.board)
        ratios.append(found.moved_px / found.expected_px)
        assert found.contradicting == ()
    assert np.sqrt(np.mean(np.square(ratios))) == pytest.approx(1, abs=0.15)


def test_two_copies_of_a_view_decide_less_than_one():
    views = make_views(CAMERAS["brown5"], 8, seed=2)
    once = influence(calibrate(views.corners, views.board, SIZE), views.board)
    heavy = int(np.argmax(once.cook))
    twin = Corners("twin", views.corners[heavy].ids, views.corners[heavy].pixels)
    twice = influence(calibrate([*views.corners, twin], views.board, SIZE), views.board)
    assert twice.cook[heavy] < 0.7 * once.cook[heavy]
    assert twice.moved_px[heavy] == pytest.approx(twice.moved_px[-1], rel=1e-3)


def test_the_only_tilted_view_decides_too_much():
    views = make_views(CAMERAS["pinhole"], 12, seed=3, tilt=0.05)
    tilted = make_views(CAMERAS["pinhole"], 12, seed=4, tilt=0.5).corners[0]
    corners = [*views.corners, Corners("tilted", tilted.ids, tilted.pixels)]
    found = influence(calibrate(corners, views.board, SIZE, Settings(model="pinhole")), views.board)
    assert int(np.argmax(found.expected_px)) == 12
    assert found.expected_px[12] > found.sigma_px


def test_a_view_that_contradicts_the_others_is_named():
    """In one view the board was pressed flat by other means: its corners are smoothly off by half a pixel."""
    views = make_views(CAMERAS["brown5"], 25, seed=5)
    off = views.corners[7]
    x = np.linspace(-1, 1, 11)
    smooth = np.stack([np.tile(x**2, 8), np.zeros(88)], axis=-1)
    views.corners[7] = Corners(off.image, off.ids, off.pixels + smooth)
    found = influence(calibrate(views.corners, views.board, SIZE), views.board)
    assert "view 7" in found.contradicting
    assert any("view 7 contradicts" in sentence for sentence in found.sentences)
    assert len(found.contradicting) <= 3


def test_a_view_that_cannot_be_missed_is_told():
    """The aspect ratio and the skew need three views; of three none can be missed."""
    views = make_views(CAMERAS["pinhole"], 3, seed=1)
    settings = Settings(model="pinhole", skew=True)
    found = influence(calibrate(views.corners, views.board, SIZE, settings), views.board)
    assert len(found.images) == 3
    assert (found.cook > 0).all()
    assert any("alone" in sentence or "undetermined" in sentence for sentence in found.sentences)


def test_pictures_of_two_cameras_are_asked_about():
    """Ten views of one camera and four of another: too many for outliers, too different for one camera."""
    first = make_views(CAMERAS["brown5"], 10, seed=1)
    other = replace(CAMERAS["brown5"], fx=1150.0, fy=1160.0, cx=600.0)
    second = [replace(view, image=f"other {view.image}") for view in make_views(other, 4, seed=2).corners]
    mixed = calibrate([*first.corners, *second], first.board, (1280, 960))
    assert any("one camera" in said for said in influence(mixed, first.board).sentences)
    alone = calibrate(first.corners, first.board, (1280, 960))
    assert not any("one camera" in said for said in influence(alone, first.board).sentences)
