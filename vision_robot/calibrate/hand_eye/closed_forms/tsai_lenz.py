"""R. Y. Tsai & R. K. Lenz, "A new technique for fully autonomous and efficient 3D robotics hand/eye
calibration", IEEE T-RA 5(3), 1989.
"""

import numpy as np

from vision_robot.calibrate.hand_eye.closed_forms.translation import mean_pose, mount_translation
from vision_robot.calibrate.hand_eye.motions import motions
from vision_robot.geometry import SE3, skew
from vision_robot.types import Array, Float

__all__ = ["solve"]


def solve(mount_from_far: SE3, cam_from_board: SE3) -> tuple[SE3, SE3]:
    """Modified Rodrigues vectors P = 2 sin(angle/2) axis: skew(Pa + Pb) P' = Pb - Pa (eq. 12), then t."""
    pairs = motions(mount_from_far, cam_from_board).have_axes
    p_a, p_b = _half_sines(pairs.turned_a), _half_sines(pairs.turned_b)
    rows, right = skew(p_a + p_b).reshape(-1, 3), (p_b - p_a).reshape(-1)
    halved = np.linalg.lstsq(rows, right, rcond=None)[0]
    p = 2 * halved / np.sqrt(1 + halved @ halved)  # eq. 14
    rotation = (1 - p @ p / 2) * np.eye(3) + 0.5 * (np.outer(p, p) + np.sqrt(4 - p @ p) * skew(p))  # eq. 10
    mount_from_cam = SE3(rotation, mount_translation(pairs, rotation))
    return mount_from_cam, mean_pose(mount_from_far.inverse() @ mount_from_cam @ cam_from_board)


def _half_sines(rotvec: Float[Array, "m 3"]) -> Float[Array, "m 3"]:
    angle = np.linalg.norm(rotvec, axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        return np.where(angle > 1e-9, 2 * np.sin(angle / 2) / np.maximum(angle, 1e-12), 1.0) * rotvec
