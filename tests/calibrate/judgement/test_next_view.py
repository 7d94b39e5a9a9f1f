"""The next best view: what it foretells comes about, and it beats the other candidates."""

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.calibrate.judgement.candidate_views import candidate_views
from vision_robot.calibrate.judgement.next_view import next_views
from vision_robot.calibrate.judgement.projection_uncertainty import picture_grid, projection_covariance
from vision_robot.errors import BadParameter

SIZE = (1280, 960)


def solved(views, corners=None, **options):
    settings = Settings(model=views.camera.model, **options)
    return calibrate(views.corners if corners is None else corners, views.board, SIZE, settings)


def sigma(result):
    covariance = projection_covariance(result, picture_grid(result.camera, 32, 24))
    return np.sqrt(np.mean(np.trace(covariance, axis1=-2, axis2=-1)))


@pytest.fixture(scope="module")
def views():
    return make_views(CAMERAS["brown5"], 8, seed=2)


@pytest.fixture(scope="module")
def advised(views):
    return next_views(solved(views), views.board)


def taken(views, pose, seed=0):
    """The corners that the true camera sees of a pose."""
    rng = np.random.default_rng(seed)
    pixels = views.camera.project(pose.apply(views.board))
    return Corners("next", np.arange(len(pixels)), pixels + 0.2 * rng.normal(size=pixels.shape))


def test_before_is_the_projection_uncertainty_there_is(views, advised):
    assert advised.sigma_px == pytest.approx(sigma(solved(views)), rel=1e-3)


def test_after_is_what_a_calibration_with_the_view_states(views, advised):
    again = solved(views, [*views.corners, taken(views, advised.cam_from_board[0])])
    assert sigma(again) == pytest.approx(advised.alone_px[0], rel=0.15)
    everything = [*views.corners, *(taken(views, advised.cam_from_board[i], i) for i in range(len(advised)))]
    named = [Corners(f"{i}", v.ids, v.pixels) for i, v in enumerate(everything)]
    assert sigma(solved(views, named)) == pytest.approx(advised.together_px[-1], rel=0.15)


def test_the_first_is_the_best_alone_and_each_more_helps(advised):
    assert advised.alone_px[0] == advised.alone_px.min()
    assert advised.together_px[0] == pytest.approx(advised.alone_px[0])
    assert (np.diff([advised.sigma_px, *advised.together_px]) < 0).all()
    assert len(set(advised.words)) == len(advised) == 5


def test_it_beats_a_typical_candidate(views, advised):
    result = solved(views)
    candidates = candidate_views(result.camera, views.board)
    rng = np.random.default_rng(0)
    others = [
        next_views(result, views.board, count=1, candidates=candidates[np.array([i])]).alone_px[0]
        for i in rng.choice(len(candidates), 15, replace=False)
    ]
    assert (advised.alone_px[0] <= np.array(others) + 1e-12).all()
    assert advised.sigma_px - advised.alone_px[0] > 2 * (advised.sigma_px - np.median(others))


def test_a_board_of_free_shape_counts_too(views):
    result = solved(views, warp=2)
    advised = next_views(result, views.board, count=2)
    assert advised.sigma_px == pytest.approx(sigma(result), rel=1e-3)
    assert advised.together_px[1] < advised.sigma_px


def test_nonsense_is_refused(views):
    with pytest.raises(BadParameter, match="next views"):
        next_views(solved(views), views.board, count=0)
