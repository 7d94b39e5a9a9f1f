"""`Picture`: it says what `projection_covariance` says, and differences are those of two cameras."""

from dataclasses import replace

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import calibrate
from vision_robot.calibrate.judgement.picture import Picture
from vision_robot.calibrate.judgement.projection_uncertainty import picture_grid, projection_covariance
from vision_robot.geometry import plane_from_pixels
from vision_robot.geometry.se3 import SE3, rotation_exp


@pytest.fixture(scope="module")
def result():
    views = make_views(CAMERAS["brown5"], 12, seed=1)
    return calibrate(views.corners, views.board, (1280, 960))


def test_the_weight_gives_the_mean_of_the_projection_covariance(result):
    C = result.covariance.intrinsics
    there = projection_covariance(result, picture_grid(result.camera, 32, 24))
    mean = np.mean(np.trace(there, axis1=-2, axis2=-1))
    picture = Picture.of(result.camera)
    assert np.sum(picture.weight() * C) == pytest.approx(mean, rel=1e-6)
    assert picture.variance(C).mean() == pytest.approx(mean, rel=1e-6)


def test_a_small_change_of_the_camera_moves_pixels_as_the_gain_says(result):
    picture = Picture.of(result.camera)
    change = 1e-3 * result.covariance.sigma
    moved = picture.difference(result.camera.with_parameters(result.camera.parameters + change))
    np.testing.assert_allclose(moved, picture.gain @ change, atol=1e-6)


def test_a_turned_camera_is_no_difference():
    """A pinhole whose principal point moves a little is the same camera turned, to first order."""
    camera = replace(CAMERAS["pinhole"], fx=50_000, fy=50_000)
    moved = replace(camera, cx=camera.cx + 1.0)
    picture = Picture.of(camera)
    assert picture.mean_square(picture.difference(moved)) < 1e-6


def test_pixels_become_lengths_on_the_plane():
    camera = CAMERAS["brown5"]
    picture = Picture.of(camera)
    facing = SE3(rotation_exp(np.zeros(3)), np.array([0, 0, 2.0]))
    step = np.array([0.01, -0.02])
    before, after = (plane_from_pixels(camera, facing, picture.pixels + s) for s in (0, step))
    np.testing.assert_allclose(2.0 * picture.on_plane @ step, after - before, rtol=1e-3, atol=1e-8)


def test_a_part_of_the_picture_chooses_its_own_rotation(result):
    picture = Picture.of(result.camera)
    left = picture.pixels[:, 0] < 400
    part = picture.where(left)
    assert len(part.pixels) == left.sum()
    C = result.covariance.intrinsics
    assert part.variance(C).mean() < picture.variance(C)[left].mean()
