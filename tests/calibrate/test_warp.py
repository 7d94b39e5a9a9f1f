"""The board's warp: blind to what poses explain, and found again when a board is bent."""

import numpy as np
import pytest

from tests.views import CAMERAS, grid_board, make_views
from vision_robot.calibrate import Corners, Settings, Warp, calibrate
from vision_robot.errors import BadParameter

SIZE = (1280, 960)


@pytest.mark.parametrize("degree", [1, 2, 3, 4])
def test_fields_are_orthonormal_and_free_of_rigid_motion_and_scale(degree):
    board = grid_board()
    warp = Warp.smooth(board, degree)
    fields = warp.basis.reshape(len(warp), -1) / np.sqrt(len(board))
    np.testing.assert_allclose(fields @ fields.T, np.eye(len(warp)), atol=1e-9)
    centred = board - board.mean(axis=0)
    rigid = [np.tile(axis, (88, 1)) for axis in np.eye(3)] + [np.cross(axis, centred) for axis in np.eye(3)]
    for field in (*rigid, centred):
        np.testing.assert_allclose(fields @ field.T.ravel(), 0, atol=1e-12)


def test_how_many_fields_there_are():
    """Degree 2: aspect and shear in the plane, three bends out of it, six quadratic in-plane fields."""
    assert len(Warp.smooth(grid_board(), 0)) == 0
    assert len(Warp.smooth(grid_board(), 1)) == 2
    assert len(Warp.smooth(grid_board(), 2)) == 2 + 3 + 6


def test_a_coefficient_is_the_rms_displacement():
    warp = Warp.smooth(grid_board(), 2)
    bent = Warp(warp.basis, np.eye(len(warp))[0] * 1e-4, warp.names)
    assert np.sqrt((bent.displacement**2).sum(axis=1).mean()) == pytest.approx(1e-4)


def test_a_bent_board_is_found_and_stops_hurting():
    views = make_views(CAMERAS["brown5"], 20, seed=3, noise_px=0.05)
    x, y, _ = (views.board - views.board.mean(axis=0)).T
    bend = 0.04 * x**2 - 0.03 * x * y  # up to 1 mm
    bent = views.board + np.stack([0 * x, 0 * x, bend], axis=-1)
    rng = np.random.default_rng(0)
    in_cam = views.cam_from_board.apply(bent)
    pixels = views.camera.project(in_cam) + 0.05 * rng.normal(size=(*in_cam.shape[:2], 2))
    corners = [Corners(v.image, v.ids, p) for v, p in zip(views.corners, pixels, strict=True)]
    flat = calibrate(corners, views.board, SIZE, Settings(robust=False))
    free = calibrate(corners, views.board, SIZE, Settings(warp=2))
    assert free.rms_px == pytest.approx(0.05 * np.sqrt(2), rel=0.05)
    assert flat.rms_px > 3 * free.rms_px
    error = np.abs(free.camera.parameters - views.camera.parameters)[free.free]
    assert (error < 4 * free.covariance.sigma[free.free]).all()
    found = free.warp.displacement[:, 2]
    rigid = np.stack([np.ones_like(x), x, y], axis=-1)
    left = bend - rigid @ np.linalg.lstsq(rigid, bend, rcond=None)[0]
    assert np.abs(found - left).max() < 2e-5


def test_degrees_the_points_cannot_carry_are_refused():
    with pytest.raises(BadParameter, match="degree"):
        Warp.smooth(grid_board(), 99)
