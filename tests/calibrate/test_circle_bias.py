"""Where a disc's outline has its centre: against closed forms, limits, and a calibration from pictures."""

from dataclasses import replace

import numpy as np
import pytest

from tests.board_photos import facing, photo
from tests.views import CAMERAS
from vision_robot.calibrate import Corners, calibrate
from vision_robot.calibrate.boards.circles import Circles
from vision_robot.calibrate.circle_bias import calibrate_circles, centre_offsets, corrected_corners
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera

POSE = SE3.from_rotvec(np.array([0.7, 0.4, 0.3]), np.array([-0.1, -0.08, 0.5]))
POSE_BATCH = SE3(POSE.rotation[None], POSE.translation[None])
BOARD = Circles(9, 6, 0.03, 0.02)


def test_pinhole_closed_form_equals_fitted_outline():
    """The projected conic and the ellipse fitted to the projected outline have one centre."""
    pinhole = replace(CAMERAS["pinhole"], skew=3.0)
    same = replace(pinhole, model="brown5", distortion=(0.0,) * 5)
    closed = centre_offsets(pinhole, POSE, BOARD.points, BOARD.radius_m)
    fitted = centre_offsets(same, POSE, BOARD.points, BOARD.radius_m)
    assert np.abs(closed).max() > 0.1
    np.testing.assert_allclose(fitted, closed, atol=1e-9)


@pytest.mark.parametrize("name", CAMERAS)
def test_offset_is_close_to_that_of_the_centroid(name):
    """An independent figure, the area centroid by Green's theorem, differs only in terms of third order."""
    camera = CAMERAS[name]
    angle = 2 * np.pi * np.arange(2000) / 2000
    circle = BOARD.radius_m * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    outline = camera.project(POSE.apply((BOARD.points[:, None] + circle).reshape(-1, 3))).reshape(54, -1, 2)
    after = np.roll(outline, -1, axis=1)
    cross = outline[..., 0] * after[..., 1] - after[..., 0] * outline[..., 1]
    centroid = ((outline + after) * cross[..., None]).sum(axis=1) / (3 * cross.sum(axis=1)[:, None])
    expected = centroid - camera.project(POSE.apply(BOARD.points))
    offsets = centre_offsets(camera, POSE, BOARD.points, BOARD.radius_m)
    assert np.abs(offsets).max() > 0.05
    np.testing.assert_allclose(offsets, expected, atol=2e-3)


def test_grows_with_the_square_of_the_radius_and_vanishes_head_on():
    """Small discs: four times the offset for twice the radius. No tilt, no lens: no offset."""
    camera = CAMERAS["brown5"]
    one = centre_offsets(camera, POSE, BOARD.points, 0.001)
    two = centre_offsets(camera, POSE, BOARD.points, 0.002)
    np.testing.assert_allclose(two, 4 * one, rtol=2e-3, atol=1e-6)
    upright = SE3(np.eye(3), np.array([-0.1, -0.08, 0.5]))
    np.testing.assert_allclose(centre_offsets(CAMERAS["pinhole"], upright, BOARD.points, 0.01), 0, atol=1e-9)


def test_correction_is_the_offset():
    """Corners corrected with the true camera lie on the projected centres, ids and sigma untouched."""
    camera, ids = CAMERAS["brown5"], np.array([3, 10, 40])
    offsets = centre_offsets(camera, POSE, BOARD.points[ids], BOARD.radius_m)
    projected = camera.project(POSE.apply(BOARD.points[ids]))
    seen = Corners("a", ids, projected + offsets, np.array([0.1, 0.2, 0.3]))
    (corrected,) = corrected_corners([seen], BOARD, camera, POSE_BATCH)
    np.testing.assert_allclose(corrected.pixels, projected, atol=1e-9)
    assert corrected.sigma_px.tolist() == [0.1, 0.2, 0.3]
    with pytest.raises(BadParameter, match="poses"):
        corrected_corners([seen, seen], BOARD, camera, POSE_BATCH)


TILTS = ((0.0, 0.0), (0.6, 0.1), (-0.6, 0.2), (0.1, 0.6), (0.2, -0.6), (0.5, 0.5), (-0.5, -0.4), (0.4, -0.5))


def test_loop_brings_the_calibration_to_the_truth():
    """From exact pictures: the projection error falls at least fivefold, below 0.03 px."""
    camera = Camera(640, 480, 560, 563, 325, 236, 0, "brown5", (-0.25, 0.08, 5e-4, -4e-4, 0.0))
    poses = [facing(BOARD, camera, fill=0.75, tilt=tilt, roll=0.1 * k) for k, tilt in enumerate(TILTS)]
    corners = []
    for k, pose in enumerate(poses):
        seen = BOARD.detect(photo(BOARD, camera, pose, noise=1, seed=k), name=f"view {k}")
        assert seen is not None
        corners.append(seen)

    def solve(views):
        return calibrate(views, BOARD.points, (640, 480))

    raw, corrected = solve(corners), calibrate_circles(corners, BOARD, solve)
    before, after = (_projection_error(result.camera, camera) for result in (raw, corrected))
    assert after < 0.03
    assert before > 5 * after
    # The residuals hardly tell: a wrong camera explains the biased centres almost as well.
    assert corrected.rms_px < raw.rms_px


def test_views_need_names():
    """Two views of one name cannot be told apart."""
    view = Corners("same", np.arange(2), np.ones((2, 2)))
    with pytest.raises(BadParameter, match="names of views"):
        calibrate_circles([view, view], BOARD, lambda views: calibrate(views, BOARD.points, (640, 480)))


def _projection_error(found: Camera, camera: Camera) -> float:
    """Rms px per point between two cameras over the picture's inner part, the best rotation taken out."""
    u, v = np.meshgrid(np.linspace(60, 580, 14), np.linspace(45, 435, 11))
    pixels = np.stack([u.ravel(), v.ravel()], axis=1)
    rays, theirs = camera.unproject(pixels), found.unproject(pixels)
    U, _, Vt = np.linalg.svd(theirs.T @ rays)
    rotation = U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt
    error = found.project(rays @ rotation.T) - pixels
    return float(np.sqrt(np.mean(np.sum(error**2, axis=1))))
