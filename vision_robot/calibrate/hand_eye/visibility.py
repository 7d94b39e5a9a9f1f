"""Which poses show the whole board well enough to be worth a picture."""

import numpy as np

from vision_robot.geometry import SE3, Camera
from vision_robot.types import Array, Bool, Float

__all__ = ["whole_board_seen"]

STEEPEST = np.cos(np.radians(65))
SMALLEST = 0.2
"""Least part of the picture's width or height that the board takes up."""


def whole_board_seen(
    camera: Camera, cam_from_board: SE3, points: Float[Array, "n 3"], *, smallest: float = SMALLEST
) -> tuple[Float[Array, "k n 2"], Bool[Array, "k"]]:
    """Pixels of all points and whether the board is wholly seen, large enough and not too slanted."""
    in_cam = cam_from_board.apply(points)
    pixels = np.full((*in_cam.shape[:-1], 2), np.nan)
    before = (in_cam[..., 2] > 0.02).all(axis=1)
    pixels[before] = camera.project(in_cam[before])
    size = np.array([camera.width, camera.height])
    edge = 0.01 * size.min()
    with np.errstate(invalid="ignore"):
        inside = ((pixels > edge) & (pixels < size - 1 - edge)).all(axis=(1, 2))
        extent = ((pixels.max(axis=1) - pixels.min(axis=1)) / size).max(axis=1)
    middle = in_cam.mean(axis=1)
    facing = (cam_from_board.rotation[..., 2] * middle).sum(axis=1) / np.linalg.norm(middle, axis=1)
    return pixels, before & inside & (extent > smallest) & (facing > STEEPEST)
