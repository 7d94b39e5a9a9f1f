"""Correlation of neighbouring residuals: none in noise, plain to see where the model is wrong."""

from dataclasses import replace

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Settings, calibrate
from vision_robot.calibrate.judgement.whiteness import neighbour_correlation, neighbour_pairs

SIZE = (1280, 960)


def test_noise_gives_zero_with_the_stated_scatter():
    z = []
    for seed in range(12):
        views = make_views(CAMERAS["brown5"], 8, seed=seed)
        z.append(neighbour_correlation(calibrate(views.corners, views.board, SIZE)).z)
    # Mean of 12 standard normals: 0 ± 0.29; their rms: 1 ± 0.2.
    assert abs(np.mean(z)) < 1.1
    assert 0.4 < np.sqrt(np.mean(np.square(z))) < 1.7


def test_a_lens_model_too_simple_correlates():
    views = make_views(CAMERAS["brown5"], 12, seed=0)
    simple = Settings(fixed={"k2": 0.0, "k3": 0.0, "p1": 0.0, "p2": 0.0}, robust=False)
    near = neighbour_correlation(calibrate(views.corners, views.board, SIZE, simple))
    assert near.value > 0.2
    assert near.z > 8


def test_errors_that_are_the_same_over_patches_correlate_nearly_wholly():
    views = make_views(CAMERAS["brown5"], 6, seed=0)
    result = calibrate(views.corners, views.board, SIZE)
    wave = [
        np.column_stack([np.sin(v.pixels[:, 0] / 60), np.cos(v.pixels[:, 1] / 60)]) for v in result.corners
    ]
    assert neighbour_correlation(replace(result, residuals=tuple(wave))).value > 0.7


def test_each_point_is_paired_with_its_nearest_once():
    pixels = np.array([[0.0, 0], [1, 0], [5, 0], [5, 2]])
    assert neighbour_pairs(pixels).tolist() == [[0, 1], [2, 3]]
    assert neighbour_pairs(np.array([[0.0, 0], [2, 0], [3, 0]])).tolist() == [[0, 1], [1, 2]]
    assert neighbour_pairs(np.zeros((1, 2))).shape == (0, 2)


def test_perfect_residuals_say_nothing():
    views = make_views(CAMERAS["brown5"], 6, seed=0)
    result = calibrate(views.corners, views.board, SIZE)
    silent = replace(result, residuals=tuple(np.zeros_like(r) for r in result.residuals))
    near = neighbour_correlation(silent)
    assert near.value == 0
    assert near.sigma == np.inf


@pytest.mark.parametrize("scale", [0.1, 10.0])
def test_the_size_of_the_noise_does_not_matter(scale):
    views = make_views(CAMERAS["brown5"], 6, seed=0)
    result = calibrate(views.corners, views.board, SIZE)
    larger = replace(result, residuals=tuple(scale * r for r in result.residuals))
    # Only the predicted pixels, and with them the poses' Jacobian, move a little.
    assert neighbour_correlation(larger).value == pytest.approx(neighbour_correlation(result).value, abs=0.02)
