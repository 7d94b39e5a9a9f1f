"""Cameras, board poses and noisy corners with exact truth, without rendering."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate import Corners
from vision_robot.geometry import SE3, Camera, rotation_exp
from vision_robot.types import Array, Float

SQUARE_M = 0.03
COLUMNS, ROWS = 11, 8

TYPICAL = {
    "pinhole": (),
    "brown5": (-0.28, 0.12, 1e-3, -5e-4, -0.03),
    "brown8": (-0.2, 0.1, 1e-3, -5e-4, 0.01, 0.1, 0.02, 0.003),
    "fisheye": (-0.02, 0.01, -0.005, 0.001),
}


@dataclass(frozen=True)
class Made:
    """Corners with noise, and the camera and poses they were made from."""

    camera: Camera
    cam_from_board: SE3
    corners: list[Corners]
    board: Float[Array, "m 3"]

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the pictures [px]."""
        return self.camera.width, self.camera.height


def board_points() -> Float[Array, "m 3"]:
    """Inner corners of an 11x8 chessboard of 30 mm squares, row by row [m]."""
    row, column = np.divmod(np.arange(COLUMNS * ROWS), COLUMNS)
    return SQUARE_M * np.stack([column, row, np.zeros_like(row)], axis=1).astype(float)


def some_camera(rng: np.random.Generator, model: str = "brown5") -> Camera:
    """A 1280x960 camera drawn about a typical one."""
    width, height = 1280, 960
    focal = (0.35 if model == "fisheye" else rng.uniform(0.7, 1.3)) * width
    cx, cy = (width - 1) / 2 + rng.normal(0, 15), (height - 1) / 2 + rng.normal(0, 15)
    lens = np.array(TYPICAL[model]) * rng.uniform(0.5, 1.2, len(TYPICAL[model]))
    return Camera(width, height, focal, focal * rng.uniform(0.99, 1.01), cx, cy, 0, model, tuple(lens))


def some_views(camera: Camera, count: int, *, seed: int, noise_px: float = 0.2) -> Made:
    """`count` pictures of the whole board: anywhere in the picture, near and far, tilted up to 55 degrees."""
    rng = np.random.default_rng([seed, 1])
    board = board_points()
    poses = some_poses(camera, count, rng)
    corners = [seen(camera, poses[i], board, rng, noise_px, f"view {i}") for i in range(count)]
    return Made(camera, poses, corners, board)


def some_poses(camera: Camera, count: int, rng: np.random.Generator) -> SE3:
    """cam_from_board of views in which the whole board is seen, by rejection."""
    board = board_points()
    rotations, translations, found = [], [], 0
    while found < count:
        k = 16 * count + 64
        ray = camera.unproject(rng.uniform(0, 1, (k, 2)) * (camera.width - 1, camera.height - 1))
        towards = rng.uniform(0, 2 * np.pi, k)
        lean = rng.uniform(0, np.radians(55), k)[:, None] * np.stack(
            [np.cos(towards), np.sin(towards)], axis=1
        )
        tilt = rotation_exp(np.column_stack([lean, np.zeros(k)]))
        roll = rotation_exp(np.column_stack([np.zeros((k, 2)), rng.uniform(-0.5, 0.5, k)]))
        axis = np.stack([-ray[:, 1], ray[:, 0], np.zeros(k)], axis=1)
        angle = np.arctan2(np.linalg.norm(axis, axis=1), ray[:, 2])
        axis *= (angle / np.maximum(np.linalg.norm(axis, axis=1), 1e-12))[:, None]
        rotation = rotation_exp(axis) @ roll @ tilt
        # At this distance the board's width fills between a quarter and nearly all of the picture's.
        per_m = camera.fx / camera.width * np.ptp(board[:, 0])
        distance = per_m / rng.uniform(0.25, 0.95, k)
        translation = distance[:, None] * ray - rotation @ board.mean(axis=0)
        with np.errstate(invalid="ignore"):
            whole = camera.sees(SE3(rotation, translation).apply(np.broadcast_to(board, (k, *board.shape))))
        usable = whole.all(axis=1)
        rotations.append(rotation[usable])
        translations.append(translation[usable])
        found += int(usable.sum())
    return SE3(np.concatenate(rotations)[:count], np.concatenate(translations)[:count])


def seen(
    camera: Camera,
    pose: SE3,
    board: Float[Array, "m 3"],
    rng: np.random.Generator,
    noise_px: float,
    name: str,
) -> Corners:
    """What a detector with Gaussian noise would report of one picture."""
    pixels = camera.project(pose.apply(board))
    return Corners(name, np.arange(len(board)), pixels + noise_px * rng.normal(size=pixels.shape))
