"""Blocks of a minimum: their sums are what complete calibrations of weighted views find."""

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Settings, calibrate
from vision_robot.calibrate.judgement.solution import solution
from vision_robot.calibrate.judgement.view_blocks import ViewBlocks

SIZE = (1280, 960)
VIEWS = 14


@pytest.fixture(scope="module", params=[0, 2])
def blocks(request):
    views = make_views(CAMERAS["brown5"], VIEWS, seed=2)
    result = calibrate(views.corners, views.board, SIZE, Settings(warp=request.param))
    return ViewBlocks.of(*solution(result, views.board)), views, result


def test_all_views_once_make_the_identity_and_no_step(blocks):
    blocks, _, result = blocks
    k = blocks.directions.shape[1]
    np.testing.assert_allclose(blocks.information.sum(axis=0), np.eye(k), atol=1e-6)
    assert np.linalg.norm(blocks.steps(np.ones((1, VIEWS)))) < 0.01 * np.sqrt(blocks.variance)
    np.testing.assert_allclose(blocks.spread(np.ones((1, VIEWS)))[0], 0, atol=1e-6 * blocks.variance)
    covariance = blocks.variance * blocks.directions @ blocks.directions.T
    free = blocks.problem.free
    np.testing.assert_allclose(
        covariance, result.covariance.shared[np.ix_(free, free)], rtol=1e-3, atol=1e-18
    )


def test_a_step_ends_at_the_minimum_of_the_weighted_views(blocks):
    blocks, _, _ = blocks
    rng = np.random.default_rng(0)
    weights = 1 + 0.5 * rng.normal(size=(3, VIEWS)).clip(-1, 1)
    for weight, step in zip(weights, blocks.steps(weights), strict=True):
        end = blocks.refitted(weight, np.zeros_like(step), tolerance=1e-3).state
        change = (end.shared_parameters - blocks.state.shared_parameters)[blocks.problem.free]
        assert np.linalg.norm(blocks.step_of(change) - step) < 0.05 * np.linalg.norm(step)


def test_twice_the_weight_is_the_view_twice(blocks):
    blocks, views, result = blocks
    weight = np.ones(VIEWS)
    weight[3] = 2
    end = blocks.refitted(weight, blocks.steps(weight[None])[0], tolerance=1e-3).state
    twice = calibrate([*views.corners, views.corners[3]], views.board, SIZE, result.settings)
    error = (end.camera.parameters - twice.camera.parameters)[twice.free] / twice.covariance.sigma[twice.free]
    assert np.abs(error).max() < 0.02


def test_imagined_steps_scatter_as_the_spread_says(blocks):
    blocks, _, _ = blocks
    rng = np.random.default_rng(1)
    weights = rng.multinomial(VIEWS, np.full(VIEWS, 1 / VIEWS), size=40).astype(float)
    weights = weights[blocks.determined(weights)][:3]
    imagined = blocks.imagined_steps(weights, 4000, rng)
    spread = blocks.spread(weights)
    for steps, expected in zip(imagined.transpose(1, 0, 2), spread, strict=True):
        found = np.sum(steps**2, axis=0) / len(steps)
        np.testing.assert_allclose(found, np.diag(expected), rtol=0.12)


def test_views_that_leave_something_undetermined_have_no_step(blocks):
    blocks, _, _ = blocks
    nothing = np.zeros((1, VIEWS))
    assert not blocks.determined(nothing)[0]
    assert np.isnan(blocks.steps(nothing)).all()
    assert blocks.determined(np.ones((1, VIEWS)))[0]
