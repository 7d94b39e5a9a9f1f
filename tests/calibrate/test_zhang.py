"""Zhang's closed form: exact on exact homographies, None where they carry no answer."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.views import CAMERAS, grid_board, make_views
from vision_robot.calibrate.zhang import (
    closed_form_intrinsics,
    closed_form_poses,
    closed_form_radial,
    focal_lengths,
)
from vision_robot.geometry import SE3, plane_homography

SIZE = (1280, 960)


def poses(seed: int, count: int) -> SE3:
    rng = np.random.default_rng(seed)
    return SE3.from_rotvec(rng.normal(size=(count, 3)) * 0.4, rng.normal(size=(count, 3)) * 0.1 + [0, 0, 1])


def found_K(homographies: np.ndarray, *, skew: bool) -> np.ndarray:
    K = closed_form_intrinsics(homographies, SIZE, skew=skew)
    assert K is not None
    return K


@given(
    st.integers(0, 10_000),
    st.floats(300, 3000),
    st.floats(0.7, 1.4),
    st.floats(400, 900),
    st.floats(300, 700),
    st.floats(-5, 5),
)
@settings(max_examples=40)
def test_exact_homographies_give_back_K(seed, fx, aspect, cx, cy, skew):
    K = np.array([[fx, skew, cx], [0, fx * aspect, cy], [0, 0, 1]])
    H = plane_homography(K, poses(seed, 6))
    np.testing.assert_allclose(found_K(H, skew=True), K, rtol=1e-5, atol=1e-3)
    K[0, 1] = 0
    H = plane_homography(K, poses(seed, 6))
    np.testing.assert_allclose(found_K(H, skew=False), K, rtol=1e-5, atol=1e-3)


def test_two_views_suffice_without_skew():
    K = CAMERAS["pinhole"].K
    H = plane_homography(K, poses(4, 2))
    np.testing.assert_allclose(found_K(H, skew=False), K, rtol=1e-6, atol=1e-4)


def test_the_scale_and_sign_of_homographies_do_not_matter():
    K = CAMERAS["pinhole"].K
    H = plane_homography(K, poses(5, 4)) * np.array([1.0, -3.0, 1e-4, 1e5])[:, None, None]
    np.testing.assert_allclose(found_K(H, skew=True), K, rtol=1e-6, atol=1e-4)


@pytest.mark.parametrize("sign", [1, -1])
def test_poses_come_back_in_front_of_the_camera(sign):
    K, truth = CAMERAS["pinhole"].K, poses(6, 5)
    found = closed_form_poses(K, sign * plane_homography(K, truth))
    np.testing.assert_allclose(found.as_matrix(), truth.as_matrix(), atol=1e-9)


def test_focal_lengths_from_a_known_principal_point():
    camera = CAMERAS["pinhole"]
    H = plane_homography(camera.K, poses(7, 3))
    found = focal_lengths(H, (camera.cx, camera.cy))
    assert found is not None
    np.testing.assert_allclose(found, (camera.fx, camera.fy), rtol=1e-9)


def test_parallel_boards_tell_no_focal_length():
    camera = CAMERAS["pinhole"]
    rng = np.random.default_rng(8)
    flat = SE3.from_rotvec(
        np.array([[0, 0, a] for a in (0.0, 0.3, 0.6)]), rng.normal(size=(3, 3)) * 0.1 + [0, 0, 1]
    )
    K = closed_form_intrinsics(plane_homography(camera.K, flat), SIZE, skew=False)
    assert K is None or not np.allclose(K, camera.K, rtol=1e-3)


def test_radial_coefficients_of_a_purely_radial_lens():
    """Equation 13 is linear in k1, k2: exact when the lens has just those and K is true."""
    truth = make_views(CAMERAS["pinhole"], 4, noise_px=0)
    K = truth.camera.K
    in_cam = truth.cam_from_board.apply(grid_board())
    xy = in_cam[..., :2] / in_cam[..., 2:]
    r2 = (xy**2).sum(axis=-1, keepdims=True)
    pixels = (xy * (1 - 0.2 * r2 + 0.05 * r2**2)) @ K[:2, :2].T + K[:2, 2]
    k1, k2 = closed_form_radial(K, in_cam, pixels, np.ones(in_cam.shape[:2]))
    assert k1 == pytest.approx(-0.2, abs=1e-9)
    assert k2 == pytest.approx(0.05, abs=1e-9)
