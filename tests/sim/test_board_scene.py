"""Rendered board corners sit on their analytic projection.

Two judges: the registration of each corner's neighbourhood against the exact area-sampled
picture (no detector enters), and the house's own corner detector.
"""

import numpy as np
import pytest

from vision_robot.calibrate.boards import Chessboard
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera, plane_from_pixels
from vision_robot.sim.board_scene import BoardPrint, render_views
from vision_robot.sim.viewpoints import board_poses

SQUARE, PIXELS = 0.03, 64
BOARD = Chessboard(7, 6, SQUARE)
K5 = (-0.25, 0.08, 0.0008, -0.0005, 0.0)

CAMERAS = {
    "centred": Camera(800, 600, 640, 640, 399.5, 299.5),
    "off-centre": Camera(800, 600, 640, 640, 361.7, 330.2),
    "unequal": Camera(800, 600, 690, 630, 420.3, 281.4),
    "brown5": Camera(800, 600, 640, 632, 410.2, 288.6, 0.0, "brown5", K5),
    "skewed": Camera(800, 600, 640, 632, 410.2, 288.6, 3.0, "brown5", K5),
    "fisheye": Camera(800, 600, 330, 326, 410.2, 288.6, 0.0, "fisheye", (-0.02, 0.005, 0.0, 0.0)),
}


def chess_print() -> BoardPrint:
    """White margin of one square around 8 x 7 squares, the first one black."""
    columns, rows = np.meshgrid(np.arange(-2, 8), np.arange(-2, 7))
    inside = (columns > -2) & (columns < 7) & (rows > -2) & (rows < 6)
    white = ~(inside & ((columns + rows) % 2 == 0))
    picture = np.kron(np.where(white, 255, 0), np.ones((PIXELS, PIXELS))).astype(np.uint8)
    return BoardPrint(picture, PIXELS / SQUARE, (2 * SQUARE, 2 * SQUARE))


def displacement(camera: Camera, cam_from_board: SE3, image, corners, half: int = 4, n: int = 6):
    """How far each corner's neighbourhood lies from the exact one [px], by least squares.

    The exact picture is the mean of n x n samples of the board in each pixel.
    """
    inside_pixel = (np.arange(n) + 0.5) / n - 0.5
    shifts = []
    for corner in corners:
        u, v = (np.arange(c - half - 1, c + half + 2) for c in np.rint(corner).astype(int))
        fine = np.stack(
            np.meshgrid((u[:, None] + inside_pixel).ravel(), (v[:, None] + inside_pixel).ravel()), -1
        )
        square = np.floor(plane_from_pixels(camera, cam_from_board, fine) / SQUARE).sum(axis=-1)
        exact = (square % 2).reshape(len(v), n, len(u), n).mean(axis=(1, 3))
        across, down = (exact[1:-1, 2:] - exact[1:-1, :-2]) / 2, (exact[2:, 1:-1] - exact[:-2, 1:-1]) / 2
        seen = image[v[1] : v[-1], u[1] : u[-1]].astype(float)
        terms = [exact[1:-1, 1:-1], np.ones_like(across), -across, -down]
        gain, _, du, dv = np.linalg.lstsq(np.stack(terms, -1).reshape(-1, 4), seen.ravel(), rcond=None)[0]
        shifts.append((du / gain, dv / gain))
    return np.array(shifts)


@pytest.mark.parametrize("name", CAMERAS)
def test_corners_sit_on_the_analytic_projection(name):
    """Picture against exact picture: <= 0.03 px rms, mean <= 0.01 px; detector: <= 0.03 and <= 0.01 px."""
    camera, board = CAMERAS[name], chess_print()
    poses = board_poses(camera, board.box_m, 4, seed=3)
    shifts, errors = [], []
    for i, image in enumerate(render_views(board, camera, poses)):
        truth = camera.project(poses[i].apply(BOARD.points))
        shifts.append(displacement(camera, poses[i], image, truth[::3]))
        found = BOARD.detect(image)
        assert found is not None
        errors.append(found.pixels - truth[found.ids])
    shifts, errors = np.concatenate(shifts), np.concatenate(errors)
    assert np.sqrt(np.mean(shifts**2)) < 0.03
    assert np.abs(shifts.mean(axis=0)).max() < 0.01
    assert np.sqrt(np.mean(errors**2)) < 0.03
    assert np.abs(errors.mean(axis=0)).max() < 0.01


def test_print_is_upright_and_unmirrored():
    """A dark mark at the print's top left is seen at the top left by a camera that faces the board."""
    picture = np.full((64, 128), 255, dtype=np.uint8)
    picture[8:24, 8:40] = 0
    board = BoardPrint(picture, 640, (0.1, 0.05))
    camera = Camera(200, 150, 150, 150, 99.5, 74.5)
    for grey in (True, False):
        (image,) = render_views(board, camera, SE3(np.eye(3)[None], np.array([[0.0, 0, 0.25]])), grey=grey)
        mark = camera.project(np.array([[24 / 640 - 0.1, 16 / 640 - 0.05, 0.25]]))[0]
        dark = np.argwhere((image if grey else image.max(axis=2)) < 60)
        assert np.abs(dark.mean(axis=0)[::-1] - mark).max() < 0.6
        assert image.ndim == (2 if grey else 3)


def test_brightness_is_even_over_the_board_and_nothing_glares():
    white = BoardPrint(np.full((64, 64), 255, dtype=np.uint8), 640, (0.05, 0.05))
    camera = Camera(200, 150, 150, 150, 99.5, 74.5)
    poses = SE3.from_rotvec(np.array([[0.0, 0, 0], [0.6, 0.3, 0]]), np.array([[0.0, 0, 0.15], [0, 0, 0.2]]))
    for image in render_views(white, camera, poses):
        centre = image[65:85, 90:110]
        assert int(centre.max()) - int(centre.min()) <= 1
        assert 150 < centre.mean() < 250
        assert 90 < image[2, 2] < 140


def test_no_pose_gives_no_picture():
    assert list(render_views(chess_print(), CAMERAS["centred"], SE3.identity(0))) == []


@pytest.mark.parametrize(
    "change",
    [
        {"picture": np.zeros((4, 4, 3), dtype=np.uint8)},
        {"picture": np.zeros((1, 9000), dtype=np.uint8)},
        {"pixels_per_metre": 0.0},
    ],
)
def test_impossible_prints_are_refused(change):
    good = {"picture": np.zeros((4, 4), dtype=np.uint8), "pixels_per_metre": 100.0, "origin_m": (0.0, 0.0)}
    with pytest.raises((BadParameter, TypeError)):
        BoardPrint(**{**good, **change})
