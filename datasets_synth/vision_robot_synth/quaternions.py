"""Rotations as quaternions, for files."""

import numpy as np

from vision_robot.geometry import rotation_log
from vision_robot.types import Array, Float

__all__ = ["quaternions"]


def quaternions(rotation: Float[Array, "n 3 3"]) -> Float[Array, "n 4"]:
    """Unit quaternions (w, x, y, z), w not negative."""
    turn = rotation_log(rotation)
    half = np.linalg.norm(turn, axis=1, keepdims=True) / 2
    return np.concatenate([np.cos(half), np.sinc(half / np.pi) * turn / 2], axis=1)
