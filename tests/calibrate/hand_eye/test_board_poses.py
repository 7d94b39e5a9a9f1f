"""Poses of the board from pictures alone: the better of two, outliers named, noise told."""

import numpy as np
import pytest

from tests.hand_eye_sets import posed
from vision_robot.calibrate import Corners
from vision_robot.calibrate.hand_eye.board_poses import find_board_poses
from vision_robot.geometry import SE3, Camera, rotation_exp


def test_poses_and_noise():
    made = posed(count=6, noise_px=0.3)
    views, usable, rejected = find_board_poses(made.corners, made.board, made.camera)
    assert usable.all()
    assert not rejected
    assert views.noise_px == pytest.approx(0.3, rel=0.1)
    off = views.cam_from_board.translation - made.cam_from_board.translation
    assert np.linalg.norm(off, axis=1).max() < 3e-3


def test_a_wrong_corner_is_named_and_a_view_without_corners_left_out():
    made = posed(count=4)
    pixels = made.corners[1].pixels.copy()
    pixels[7] += 40
    corners = [
        made.corners[0],
        Corners("bad corner", made.corners[1].ids, pixels),
        Corners("few", np.arange(3), pixels[:3]),
        made.corners[3],
    ]
    views, usable, rejected = find_board_poses(corners, made.board, made.camera)
    assert usable.tolist() == [True, True, False, True]
    assert len(views) == 3
    assert [(one.image, one.corner) for one in rejected] == [("few", None), ("bad corner", 7)]


def test_of_two_poses_of_a_small_board_the_better_one_is_taken():
    """From afar a tilt and its mirror image look nearly alike; a descent from one start finds either."""
    camera = Camera(1280, 960, 3000, 3000, 639.5, 479.5)
    x, y = np.meshgrid(np.arange(5), np.arange(4))
    board = 0.02 * np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    rng = np.random.default_rng(0)
    turns = rotation_exp(np.radians(rng.uniform(-40, 40, (40, 3))))
    true = SE3(turns, np.tile([0.0, 0.0, 2.5], (40, 1)))
    pixels = camera.project(true.apply(board)) + 0.05 * rng.normal(size=(40, 20, 2))
    corners = [Corners(f"{i}", np.arange(20), seen) for i, seen in enumerate(pixels)]
    views, _, _ = find_board_poses(corners, board, camera)
    off = SE3(views.cam_from_board.rotation @ np.swapaxes(turns, 1, 2), np.zeros((40, 3))).rotvec()
    assert (np.linalg.norm(off, axis=1) < np.radians(8)).mean() >= 0.9
