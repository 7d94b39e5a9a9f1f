"""Board poses are what a careful person would hold: whole, tilted, all over the picture."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera
from vision_robot.sim.viewpoints import board_poses

BOX = (-0.05, -0.05, 0.25, 0.175)
CAMERAS = {
    "pinhole": Camera(1280, 960, 1000, 1010, 600, 500),
    "brown5": Camera(1280, 960, 1000, 1010, 650, 470, 0.0, "brown5", (-0.25, 0.09, 0.0006, -0.0004, -0.01)),
    "tele": Camera(640, 480, 3000, 3000, 320, 240),
    "fisheye": Camera(1280, 960, 420, 425, 652, 469, 0.0, "fisheye", (-0.02, 0.005, 0.0, 0.0)),
    "circle": Camera(800, 800, 150, 150, 399.5, 399.5, model="fisheye", distortion=(-0.02, 0.0, 0.0, 0.0)),
}


@pytest.mark.parametrize("name", CAMERAS)
def test_the_whole_print_is_in_every_picture_with_a_margin(name):
    camera = CAMERAS[name]
    poses = board_poses(camera, BOX, 24, seed=5)
    left, top, right, bottom = BOX
    x, y = np.meshgrid(np.linspace(left, right, 9), np.linspace(top, bottom, 9))
    points = np.stack([x.ravel(), y.ravel(), np.zeros(81)], axis=1)
    pixels = camera.project(poses.apply(points))
    margin = 0.01 * min(camera.width, camera.height)
    assert np.isfinite(pixels).all()
    assert (pixels > margin).all()
    assert (pixels < np.array([camera.width, camera.height]) - margin).all()


@pytest.mark.parametrize("name", CAMERAS)
def test_boards_face_the_camera_and_tilt_in_all_directions(name):
    """The normal is 0 to 50 degrees from the line of sight, evenly, and no point is seen too flat."""
    poses = board_poses(CAMERAS[name], BOX, 24, seed=5)
    middle = np.array([[(BOX[0] + BOX[2]) / 2, (BOX[1] + BOX[3]) / 2, 0.0]])
    sight = poses.apply(middle)[:, 0]
    sight = sight / np.linalg.norm(sight, axis=1, keepdims=True)
    tilt = np.rad2deg(np.arccos(np.clip((poses.rotation[:, :, 2] * sight).sum(axis=1), -1, 1)))
    assert tilt.max() <= 50 + 1e-6
    assert (np.histogram(tilt, bins=[0, 10, 20, 30, 40, 50.001])[0] >= 3).all()
    leaning = (poses.inverse().rotation @ sight[..., None])[:, :2, 0]  # line of sight in the board frame
    quadrants = (leaning[:, 0] > 0).astype(int) + 2 * (leaning[:, 1] > 0)
    assert (np.bincount(quadrants, minlength=4) >= 3).all()
    corners = np.array([[x, y, 0] for x in BOX[::2] for y in BOX[1::2]])
    to_corner = poses.apply(corners)
    to_corner = to_corner / np.linalg.norm(to_corner, axis=-1, keepdims=True)
    flatness = (to_corner * poses.rotation[:, None, :, 2]).sum(axis=-1)
    assert flatness.min() > np.cos(np.deg2rad(66))


@pytest.mark.parametrize("name", ["pinhole", "brown5", "tele", "fisheye"])
def test_the_picture_is_covered_into_its_corners(name):
    """Prints come within a tenth of the picture of all four sides and hit every cell of a 4 x 4 grid."""
    camera = CAMERAS[name]
    poses = board_poses(camera, BOX, 24, seed=1)
    x, y = np.meshgrid(np.linspace(BOX[0], BOX[2], 12), np.linspace(BOX[1], BOX[3], 12))
    pixels = camera.project(poses.apply(np.stack([x.ravel(), y.ravel(), np.zeros(144)], axis=1)))
    share = pixels.reshape(-1, 2) / (camera.width, camera.height)
    assert share.min() < 0.05
    assert share.max() > 0.95
    cells = np.floor(4 * share).astype(int)
    assert len(np.unique(cells, axis=0)) == 16


def test_distance_and_roll_vary():
    poses = board_poses(CAMERAS["pinhole"], BOX, 24, seed=1)
    distance = np.linalg.norm(poses.translation, axis=1)
    assert distance.max() / distance.min() > 1.5
    roll = np.rad2deg(np.arctan2(poses.rotation[:, 1, 0], poses.rotation[:, 0, 0]))
    assert roll.std() > 5
    assert np.abs(roll).max() < 60


def test_the_seed_decides():
    first, same, other = (board_poses(CAMERAS["brown5"], BOX, 6, seed=s).as_matrix() for s in (4, 4, 5))
    assert (first == same).all()
    assert not np.allclose(first, other)


@pytest.mark.parametrize("change", [{"count": 0}, {"tilt": 1.5}])
def test_impossible_wishes_are_refused(change):
    arguments = {"count": 3, **change}
    with pytest.raises(BadParameter):
        board_poses(CAMERAS["pinhole"], BOX, **arguments)


def test_a_camera_no_board_fits_into_is_refused():
    """A lens that folds at once sees nothing of the picture's surroundings."""
    blind = Camera(640, 480, 10, 10, 5000, 5000, model="brown5", distortion=(-0.5, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(BadParameter, match="camera"):
        board_poses(blind, BOX, 3)
