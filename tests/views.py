"""Corner sets with exact truth, made without rendering."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate import Corners
from vision_robot.geometry import SE3, Camera

CAMERAS = {
    "pinhole": Camera(1280, 960, 1000, 1010, 650, 470),
    "brown5": Camera(1280, 960, 1000, 1010, 650, 470, 0, "brown5", (-0.28, 0.09, 1e-3, -5e-4, -0.01)),
    "brown8": Camera(
        1280, 960, 1000, 1010, 650, 470, 0, "brown8", (-0.2, 0.1, 1e-3, -5e-4, 0.01, 0.1, 0.02, 0.003)
    ),
    "fisheye": Camera(1280, 960, 400, 402, 650, 470, 0, "fisheye", (-0.02, 0.01, -0.005, 0.001)),
}


def grid_board(columns: int = 11, rows: int = 8, square_m: float = 0.03) -> np.ndarray:
    """Inner corners (n, 3) of a chessboard, row by row [m]."""
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    return np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3) * square_m


@dataclass(frozen=True)
class Views:
    """Noisy corners, the truth they were made from, and the board."""

    camera: Camera
    cam_from_board: SE3
    corners: list[Corners]
    board: np.ndarray


def make_views(
    camera: Camera, count: int, *, seed: int = 0, noise_px: float = 0.2, tilt: float = 0.4
) -> Views:
    """Views with the whole board in the picture; `tilt` is the spread of the rotation vector [rad]."""
    rng = np.random.default_rng(seed)
    board = grid_board()
    reach = 1000 / camera.fx if camera.model != "fisheye" else 1.0
    corners, rotvecs, translations = [], [], []
    while len(corners) < count:
        rotvec = rng.normal(size=3) * tilt
        centre = np.array([rng.uniform(-0.4, 0.4), rng.uniform(-0.3, 0.3), rng.uniform(0.3, 1.0) / reach])
        pose = SE3.from_rotvec(rotvec, np.zeros(3))
        pose = SE3(pose.rotation, centre - pose.rotation @ board.mean(axis=0))
        in_cam = pose.apply(board)
        if not camera.sees(in_cam).all():
            continue
        pixels = camera.project(in_cam) + rng.normal(size=(len(board), 2)) * noise_px
        corners.append(Corners(f"view {len(corners)}", np.arange(len(board)), pixels))
        rotvecs.append(rotvec)
        translations.append(pose.translation)
    return Views(camera, SE3.from_rotvec(np.array(rotvecs), np.array(translations)), corners, board)
