"""A camera over a table, a board on it, and noisy corners with exact truth."""

import numpy as np

from tests.views import grid_board
from vision_robot.calibrate import Corners
from vision_robot.geometry import SE3, Camera, rotation_exp

CAMERA = Camera(1280, 960, 1000, 1010, 650, 470, 0, "brown5", (-0.28, 0.09, 1e-3, -5e-4, -0.01))
BOARD = grid_board(9, 6, 0.025)


def looking_down(elevation: float = 60.0, distance: float = 0.7, azimuth: float = 20.0) -> SE3:
    """cam_from_station of a camera that looks at the middle of the table under so many degrees."""
    e, a = np.radians([elevation, azimuth])
    eye = distance * np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    forward = -eye / distance
    right = np.cross(forward, [0, 0, 1.0])
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(forward, right), forward])
    return SE3(rotation, -rotation @ eye)


def seen(
    camera: Camera,
    cam_from_station: SE3,
    station_from_board: SE3,
    *,
    noise_px: float = 0.1,
    seed: int = 0,
    name: str = "table.png",
    board: np.ndarray = BOARD,
) -> Corners:
    """The board's corners as a detector with Gaussian noise reports them."""
    pixels = camera.project((cam_from_station @ station_from_board).apply(board))
    noise = np.random.default_rng(seed).normal(size=pixels.shape) * noise_px
    return Corners(name, np.arange(len(board)), pixels + noise)


def lying(x: float = -0.1, y: float = 0.07, yaw: float = 0.0, height: float = 0.0) -> SE3:
    """station_from_board of a board that lies face up."""
    turn = rotation_exp(np.array([0, 0, yaw])) @ np.diag([1.0, -1.0, -1.0])
    return SE3(turn, np.array([x, y, height]))
