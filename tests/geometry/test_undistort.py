"""Resampling maps agree with OpenCV's and undo each other."""

import cv2
import numpy as np

from vision_robot.geometry import Camera, pixel_grid, resampling_map

BROWN5 = Camera(320, 240, 250, 260, 150.5, 125.2, 0.0, "brown5", (-0.28, 0.09, 0.001, -0.0007, -0.01))
FISHEYE = Camera(320, 240, 150, 151, 150.5, 125.2, 0.0, "fisheye", (-0.02, 0.006, 0.0, 0.0))


def test_undistortion_map_is_opencvs():
    ours = resampling_map(BROWN5, BROWN5.without_distortion())
    u, v = cv2.initUndistortRectifyMap(
        BROWN5.K, np.array(BROWN5.distortion), np.eye(3), BROWN5.K, (320, 240), cv2.CV_32FC1
    )
    assert np.allclose(ours, np.stack([u, v], axis=-1), atol=1e-4)


def test_fisheye_undistortion_map_is_opencvs():
    ours = resampling_map(FISHEYE, FISHEYE.without_distortion())
    u, v = cv2.fisheye.initUndistortRectifyMap(
        FISHEYE.K, np.array(FISHEYE.distortion), np.eye(3), FISHEYE.K, (320, 240), cv2.CV_32FC1
    )
    assert np.allclose(ours, np.stack([u, v], axis=-1), atol=1e-4)


def test_a_map_to_the_same_camera_moves_nothing():
    assert np.allclose(resampling_map(BROWN5, BROWN5), pixel_grid(320, 240), atol=1e-9)


def test_maps_in_both_directions_undo_each_other():
    """The map from a lens to a pinhole, taken at the pixels of the map back, is the identity."""
    pinhole = BROWN5.without_distortion()
    there = resampling_map(pinhole, BROWN5)
    back = BROWN5.project(pinhole.unproject(there))
    assert np.allclose(back, pixel_grid(320, 240), atol=1e-9)


def test_nan_where_the_source_does_not_see():
    narrow = Camera(320, 240, 250, 250, 159.5, 119.5, model="brown5", distortion=(-0.5, 0, 0, 0, 0))
    wide = Camera(320, 240, 100, 100, 159.5, 119.5)
    seen = np.isfinite(resampling_map(narrow, wide)[..., 0])
    assert seen[120, 160]
    assert not seen[0, 0]
