"""`projection_error` against hand-worked cameras: what a shift, a zoom and a turn must give."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.evaluate import projection_difference, projection_error
from vision_robot.geometry import Camera, rotation_exp

WIDE = Camera(1280, 960, 1000, 1010, 650, 470, 0, "brown5", (-0.28, 0.09, 1e-3, -5e-4, -0.01))
FISHEYE = Camera(1280, 960, 400, 402, 650, 470, 0, "fisheye", (-0.02, 0.01, -0.005, 0.001))
NARROW = Camera(1280, 960, 50_000, 50_000, 639.5, 479.5)


@pytest.mark.parametrize("camera", [WIDE, FISHEYE, NARROW])
@pytest.mark.parametrize("fit_rotation", [False, True])
def test_a_camera_does_not_differ_from_itself(camera, fit_rotation):
    error = projection_error(camera, camera, fit_rotation=fit_rotation)
    assert error.rms_px < 1e-8
    assert error.max_px < 1e-7
    assert error.compared == 1


def test_a_principal_point_one_pixel_off_is_one_pixel_everywhere_and_a_rotation_in_a_narrow_lens():
    shifted = Camera(1280, 960, 50_000, 50_000, 640.5, 479.5)
    plain = projection_error(shifted, NARROW)
    assert (plain.rms_px, plain.max_px) == pytest.approx((1, 1))
    turned = projection_error(shifted, NARROW, fit_rotation=True)
    # x^2 f theta is what a rotation leaves: 1 px times (640 / 50000)^2 at the side.
    assert turned.max_px < 2e-4
    # A ray to the right lands 1 px too far right unless turned left by 1/f about y.
    assert turned.rotation == pytest.approx([0, -1 / 50_000, 0], abs=1e-8)


def test_a_focal_length_off_by_a_thousandth_moves_pixels_in_proportion_to_their_radius():
    zoomed = Camera(1280, 960, 50_050, 50_050, 639.5, 479.5)
    plain = projection_error(zoomed, NARROW)
    assert plain.max_px == pytest.approx(1e-3 * np.hypot(639.5, 479.5), rel=1e-6)
    # Mean of u^2 + v^2 over a grid of n x m points that reach the edges: a^2 (n+1)/(3 (n-1)) for each axis.
    mean = 639.5**2 * 65 / (3 * 63) + 479.5**2 * 49 / (3 * 47)
    assert plain.rms_px == pytest.approx(1e-3 * np.sqrt(mean), rel=1e-6)
    # No rotation is a zoom.
    assert projection_error(zoomed, NARROW, fit_rotation=True).rms_px == pytest.approx(plain.rms_px, rel=1e-3)


def test_a_rotation_of_the_rays_shows_as_itself():
    rotation = np.array([1e-3, -2e-3, 3e-3])
    pixels = np.array([[100.0, 200.0], [640.0, 480.0]])
    expected = WIDE.project(WIDE.unproject(pixels) @ rotation_exp(rotation).T) - pixels
    assert projection_difference(WIDE, WIDE, pixels, rotation=rotation) == pytest.approx(expected)


@pytest.mark.parametrize("camera", [WIDE, FISHEYE])
def test_fitting_a_rotation_never_makes_it_worse_and_is_a_minimum(camera):
    changed = camera.parameters
    changed[:4] += [2, -1, 3, -2]
    other = camera.with_parameters(changed)
    plain, fitted = projection_error(other, camera), projection_error(other, camera, fit_rotation=True)
    assert fitted.rms_px < plain.rms_px
    u, v = np.linspace(0, 1279, 64), np.linspace(0, 959, 48)
    grid = np.stack(np.meshgrid(u, v), axis=-1)
    for step in 1e-4 * np.vstack([np.eye(3), -np.eye(3)]):
        beside = projection_difference(other, camera, grid, rotation=fitted.rotation + step)
        assert np.sqrt(np.nanmean(np.sum(beside**2, axis=-1))) > fitted.rms_px


def test_what_only_one_camera_sees_is_left_out_and_counted():
    folding = Camera(1280, 960, 1000, 1000, 639.5, 479.5, 0, "brown5", (-0.9, 0, 0, 0, 0))
    error = projection_error(folding, folding)
    assert error.rms_px < 1e-6
    assert 0.1 < error.compared < 1


def test_pictures_of_different_size_are_not_compared():
    other = Camera(640, 480, 500, 500, 320, 240)
    with pytest.raises(BadParameter, match=r"camera size is \(640, 480\)"):
        projection_error(other, WIDE)
