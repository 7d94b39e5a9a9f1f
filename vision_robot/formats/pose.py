"""A rigid transform in our JSON: ``{"rotvec_rad": [x, y, z], "translation_m": [x, y, z]}``."""

from collections.abc import Sequence

import numpy as np

from vision_robot.formats.tree import Tree
from vision_robot.geometry import SE3

__all__ = ["pose_object", "read_matrix", "read_pose", "stacked"]

ROUNDED = 1e-3
"""A matrix farther from a rotation than this was not merely rounded."""


def pose_object(pose: SE3) -> dict[str, object]:
    """The object to write."""
    return {"rotvec_rad": pose.rotvec().tolist(), "translation_m": pose.translation.tolist()}


def read_pose(tree: Tree) -> SE3:
    """The transform; raises BadCameraFile where a key or a number is missing."""
    rotvec, translation = (tree.get(key).numbers(3) for key in ("rotvec_rad", "translation_m"))
    return SE3.from_rotvec(np.array(rotvec), np.array(translation))


def read_matrix(tree: Tree) -> SE3:
    """The transform of a 4x4 matrix; raises BadCameraFile where its rotation is none."""
    matrix = np.array(tree.numbers(16)).reshape(4, 4)
    if not np.allclose(matrix[3], [0, 0, 0, 1], atol=1e-9):
        raise tree.bad(f"its last row must be 0 0 0 1, not {matrix[3].tolist()}")
    R = matrix[:3, :3]
    off = float(np.abs(R @ R.T - np.eye(3)).max())
    if off > ROUNDED or np.linalg.det(R) < 0:
        raise tree.bad(f"no rotation (largest entry of R R^T - 1 is {off:.2g}, det {np.linalg.det(R):.3g})")
    if off > 1e-14:  # rounded by its writer: the nearest rotation
        U, _, Vt = np.linalg.svd(R)
        R = U @ Vt
    return SE3(R, matrix[:3, 3])


def stacked(poses: Sequence[SE3]) -> SE3:
    """One batch of single transforms."""
    return SE3(np.stack([pose.rotation for pose in poses]), np.stack([pose.translation for pose in poses]))
