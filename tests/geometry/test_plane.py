"""The work plane: both ways, the horizon, and the homography against ray casting."""

import numpy as np
import pytest

from vision_robot.geometry import (
    SE3,
    Camera,
    pixel_grid,
    pixels_from_plane,
    plane_from_pixels,
    plane_homography,
)

PINHOLE = Camera(640, 480, 500, 520, 300, 260)
BROWN5 = Camera(640, 480, 500, 520, 300, 260, 1.5, "brown5", (-0.2, 0.05, 0.001, 0.002, 0))
FISHEYE = Camera(640, 480, 220, 220, 300, 260, 0, "fisheye", (-0.02, 0.004, 0, 0))
TILTED = SE3.from_rotvec(np.array([0.4, -0.2, 0.1]), np.array([0.02, -0.05, 0.8]))


@pytest.mark.parametrize("camera", [PINHOLE, BROWN5, FISHEYE], ids=["pinhole", "brown5", "fisheye"])
def test_pixels_to_plane_and_back(camera):
    pixels = pixel_grid(640, 480)[::40, ::40]
    positions = plane_from_pixels(camera, TILTED, pixels)
    on_plane = np.isfinite(positions[..., 0])
    assert on_plane.mean() > 0.7
    back = pixels_from_plane(camera, TILTED, positions[on_plane])
    assert np.abs(back - pixels[on_plane]).max() < 1e-8


def test_homography_is_ray_casting_for_a_pinhole():
    pixels = pixel_grid(640, 480)[::60, ::60].reshape(-1, 2)
    H = np.linalg.inv(plane_homography(PINHOLE.K, TILTED))
    mapped = np.column_stack([pixels, np.ones(len(pixels))]) @ H.T
    assert np.allclose(mapped[:, :2] / mapped[:, 2:], plane_from_pixels(PINHOLE, TILTED, pixels), atol=1e-12)


def test_homographies_of_a_batch():
    poses = SE3.exp(np.random.default_rng(0).normal(size=(4, 6)))
    H = plane_homography(PINHOLE.K, poses)
    assert H.shape == (4, 3, 3)
    assert np.allclose(H[2], plane_homography(PINHOLE.K, poses[2]))


def test_nothing_at_and_above_the_horizon():
    """A level camera 0.5 m above the table: its horizon is the row of the principal point."""
    # Camera z along the table's y, camera y down on the table.
    looking_level = SE3(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), np.array([0, 0.5, 0]))
    pixels = np.array([[300.0, 261], [300, 260], [300, 259], [10, 100], [300, 260 + 520]])
    positions = plane_from_pixels(PINHOLE, looking_level, pixels)
    assert np.isfinite(positions).all(axis=1).tolist() == [True, False, False, False, True]
    assert np.allclose(positions[0], [0, 0.5 * 520])
    assert np.allclose(positions[4], [0, 0.5])


def test_points_behind_the_camera_have_no_pixel():
    looking_level = SE3(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), np.array([0, 0.5, 0]))
    assert np.isnan(pixels_from_plane(PINHOLE, looking_level, np.array([[0.0, -1.0]]))).all()
    assert np.isfinite(pixels_from_plane(PINHOLE, looking_level, np.array([[0.0, 1.0]]))).all()
