"""Bootstrap over views: agrees with the covariance when all is right, and sees what it cannot."""

import numpy as np
import pytest

from tests.bent import bent
from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Settings, calibrate
from vision_robot.calibrate.judgement.bootstrap import bootstrap
from vision_robot.calibrate.judgement.solution import solution
from vision_robot.calibrate.judgement.view_blocks import ViewBlocks
from vision_robot.errors import BadParameter, DegenerateViews

SIZE = (1280, 960)


def test_under_the_right_model_it_agrees_with_the_covariance_and_holds_the_truth():
    held, ratios, chances = [], [], []
    for seed in range(12):
        views = make_views(CAMERAS["brown5"], 16, seed=seed)
        result = calibrate(views.corners, views.board, SIZE)
        found = bootstrap(result, views.board)
        truth, free = views.camera.parameters[result.free], result.free
        low, high = found.interval()[free].T
        held.append((low < truth) & (truth < high))
        ratios.append(found.typical_ratio)
        chances.append(found.chance)
    assert np.mean(ratios) == pytest.approx(1, abs=0.1)
    # 12 x 9 parameters that hang together in threes: 95 % to 4 %.
    assert np.mean(held) == pytest.approx(0.95, abs=0.08)
    assert np.mean(np.array(chances) < 0.01) <= 0.1
    assert 0.2 < np.mean(chances) < 0.7


def test_a_bent_board_taken_for_flat_shows_though_the_covariance_is_silent():
    views = bent(make_views(CAMERAS["brown5"], 25, seed=0), by_m=1e-3)
    flat, free = (
        bootstrap(calibrate(views.corners, views.board, SIZE, Settings(warp=degree)), views.board)
        for degree in (0, 2)
    )
    assert not flat.honest
    assert flat.typical_ratio > 1.5
    assert "wrong" in flat.sentence
    assert free.honest
    assert free.typical_ratio == pytest.approx(1, abs=0.3)
    assert "no model error" in free.sentence


def test_draws_are_the_minima_of_the_drawn_views():
    views = make_views(CAMERAS["brown5"], 20, seed=3)
    result = calibrate(views.corners, views.board, SIZE)
    blocks = ViewBlocks.of(*solution(result, views.board))
    weights = np.random.default_rng(0).multinomial(20, np.full(20, 1 / 20), size=4).astype(float)
    for weight, step in zip(weights, blocks.steps(weights), strict=True):
        drawn = [view for view, count in zip(views.corners, weight, strict=True) for _ in range(int(count))]
        camera = calibrate(drawn, views.board, SIZE, Settings(robust=False)).camera
        exact = blocks.step_of((camera.parameters - result.camera.parameters)[result.free])
        assert np.linalg.norm(exact - step) < 0.05 * np.linalg.norm(exact)
    assert bootstrap(result, views.board).one_step_error < 0.05


def test_what_is_fixed_stays_and_has_no_ratio():
    views = make_views(CAMERAS["brown5"], 10, seed=4)
    found = bootstrap(calibrate(views.corners, views.board, SIZE, Settings(fixed={"k3": 0.0})), views.board)
    fixed = [found.names.index(name) for name in ("skew", "k3")]
    assert np.isnan(found.ratio[fixed]).all()
    assert (found.sigma[fixed] == 0).all()
    assert (found.draws[:, fixed] == 0).all()


def test_the_seed_decides():
    views = make_views(CAMERAS["fisheye"], 10, seed=5)
    result = calibrate(views.corners, views.board, SIZE, Settings(model="fisheye"))
    first, again, other = (bootstrap(result, views.board, resamples=50, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.draws, again.draws)
    assert first.chance == again.chance
    assert np.abs(first.draws - other.draws).max() > 0
    assert first.draws.shape == (50, 9)


def test_intervals_grow_with_the_level():
    views = make_views(CAMERAS["pinhole"], 8, seed=6)
    found = bootstrap(calibrate(views.corners, views.board, SIZE, Settings(model="pinhole")), views.board)
    narrow, wide = found.interval(0.5), found.interval(0.99)
    assert (wide[:4, 0] < narrow[:4, 0]).all()
    assert (wide[:4, 1] > narrow[:4, 1]).all()
    with pytest.raises(BadParameter, match="level"):
        found.interval(1.0)


def test_too_few_draws_or_views_are_refused():
    views = make_views(CAMERAS["brown5"], 8)
    with pytest.raises(BadParameter, match="resamples"):
        bootstrap(calibrate(views.corners, views.board, SIZE), views.board, resamples=1)
    corners = make_views(CAMERAS["brown5"], 3, seed=1).corners
    few = calibrate(corners, views.board, SIZE)
    try:
        found = bootstrap(few, views.board)
    except DegenerateViews:
        return
    assert np.isfinite(found.draws).all()
