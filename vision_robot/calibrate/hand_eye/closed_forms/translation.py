"""Where the camera sits once it is known how it is turned; and the board from both."""

import numpy as np

from vision_robot.calibrate.hand_eye.motions import Motions
from vision_robot.geometry import SE3
from vision_robot.types import Array, Float

__all__ = ["mean_pose", "mount_translation", "nearest_rotation"]


def mount_translation(pairs: Motions, rotation: Float[Array, "3 3"]) -> Float[Array, "3"]:
    """Least squares of ``(R_A - I) t = R t_B - t_A`` over all motions [m]."""
    rows = (pairs.a.rotation - np.eye(3)).reshape(-1, 3)
    right = (pairs.b.translation @ rotation.T - pairs.a.translation).reshape(-1)
    return np.linalg.lstsq(rows, right, rcond=None)[0]


def mean_pose(poses: SE3) -> SE3:
    """Mean of poses that differ by noise: the nearest rotation to the mean matrix, the mean translation."""
    return SE3(nearest_rotation(poses.rotation.mean(axis=0)), poses.translation.mean(axis=0))


def nearest_rotation(matrix: Float[Array, "*batch 3 3"]) -> Float[Array, "*batch 3 3"]:
    """The rotation nearest to a matrix in Frobenius norm."""
    U, _, Vt = np.linalg.svd(matrix)
    U = np.array(U)
    U[..., 2] *= np.linalg.det(U @ Vt)[..., None]
    return U @ Vt
