"""A rigid transform in our JSON: ``{"rotvec_rad": [x, y, z], "translation_m": [x, y, z]}``."""

import numpy as np

from vision_robot.formats.tree import Tree
from vision_robot.geometry import SE3

__all__ = ["pose_object", "read_pose"]


def pose_object(pose: SE3) -> dict[str, object]:
    """The object to write."""
    return {"rotvec_rad": pose.rotvec().tolist(), "translation_m": pose.translation.tolist()}


def read_pose(tree: Tree) -> SE3:
    """The transform; raises BadCameraFile where a key or a number is missing."""
    rotvec, translation = (tree.get(key).numbers(3) for key in ("rotvec_rad", "translation_m"))
    return SE3.from_rotvec(np.array(rotvec), np.array(translation))
