"""What looks say of a camera: exact where they determine it, honest where they do not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_robot.geometry import SE3, WorkPlane
from vision_robot.pick.servo.camera_shift import camera_shift
from vision_robot.pick.servo.stage import Glimpse
from vision_robot.pick.sighting import Sighting
from vision_robot.pick.world import ordinary_world

VIEW = ordinary_world().view
THEN = WorkPlane.exact(VIEW.camera, VIEW.cam_from_station)
PRIOR = (np.radians(2.0), 0.02)
SPREAD = np.array(
    [[-0.08, -0.1, 0.05], [0.07, -0.09, 0.2], [0.05, 0.1, 0.06], [-0.06, 0.08, 0.22], [0, 0, 0.1]]
)
OVER = np.array([[0.02, 0.03, 0.215], [0.02, 0.03, 0.085]])
FIRST = Sighting(np.array([0.02, 0.03]), 1e-8 * np.eye(2), 0.4, 0.005)
THREE = st.tuples(*3 * [st.floats(-1.0, 1.0)])


def glimpses(knock, points, sigma_px=0.1, rng=None):
    pixels = VIEW.camera.project((knock @ VIEW.cam_from_station).apply(points))
    if rng is not None:
        pixels = pixels + rng.normal(0, sigma_px, pixels.shape)
    return [Glimpse(0.0, pixel, point, sigma_px) for pixel, point in zip(pixels, points, strict=True)]


@given(THREE, THREE)
def test_looks_from_all_over_tell_the_shift(turn, shift):
    knock = SE3.from_rotvec(np.radians(3) * np.array(turn), 0.02 * np.array(shift))
    found = camera_shift(THEN, glimpses(knock, SPREAD, 1e-3), *PRIOR)
    off = found.now_from_then.inverse() @ knock
    assert np.linalg.norm(off.rotvec()) < 2e-5
    assert np.linalg.norm(off.translation) < 2e-5


def test_before_any_look_it_is_what_was_believed_before():
    found = camera_shift(THEN, [], *PRIOR)
    assert np.allclose(found.now_from_then.as_matrix(), np.eye(4))
    assert np.allclose(np.sqrt(np.diag(found.covariance)), np.repeat(PRIOR, 3))
    again, sigma = found.met_again(FIRST)
    assert np.allclose(again.position_m, FIRST.position_m, atol=1e-9)
    assert again.yaw_rad == pytest.approx(FIRST.yaw_rad)
    assert sigma > 0.02


def test_two_heights_tell_the_place_that_one_does_not():
    """From one height a turn and a shift look alike, and at another height they differ."""
    knock = SE3.from_rotvec(np.radians([1.5, 1.0, 0.0]), np.zeros(3))
    pixel = VIEW.camera.project((knock @ VIEW.cam_from_station).apply(np.array([[0.02, 0.03, 0.005]])))
    seen = Sighting(THEN.measure(pixel, z_m=0.005)[0][0], np.zeros((2, 2)), 0.4, 0.005)
    one, sigma_one = camera_shift(THEN, glimpses(knock, OVER[1:]), *PRIOR).met_again(seen)
    both, sigma_both = camera_shift(THEN, glimpses(knock, OVER), *PRIOR).met_again(seen)
    assert np.linalg.norm(one.position_m - OVER[0, :2]) > 5e-4
    assert np.linalg.norm(both.position_m - OVER[0, :2]) < 5e-5
    assert sigma_both < 0.2 * sigma_one


def test_residuals_that_noise_does_not_explain_widen_what_is_stated():
    knock = SE3.identity()
    honest = camera_shift(THEN, glimpses(knock, SPREAD, 0.1, np.random.default_rng(0)), *PRIOR)
    rough = [
        Glimpse(0.0, one.pixel, one.label_in_station, 0.1)
        for one in glimpses(knock, SPREAD, 1.0, np.random.default_rng(0))
    ]
    assert camera_shift(THEN, rough, *PRIOR).met_again(FIRST)[1] > 3 * honest.met_again(FIRST)[1]
