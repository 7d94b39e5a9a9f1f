"""F. C. Park & B. J. Martin, "Robot sensor calibration: solving AX = XB on the Euclidean group", 1994."""

from vision_robot.calibrate.hand_eye.closed_forms.translation import (
    mean_pose,
    mount_translation,
    nearest_rotation,
)
from vision_robot.calibrate.hand_eye.motions import motions
from vision_robot.geometry import SE3

__all__ = ["solve"]


def solve(mount_from_far: SE3, cam_from_board: SE3) -> tuple[SE3, SE3]:
    """Rotation vectors of the arm are those of the pictures, turned: alpha = R beta; then the translation.

    Motions near half a turn are left out, since noise may turn the sign of their axis.
    """
    pairs = motions(mount_from_far, cam_from_board).have_axes
    # (M^T M)^(-1/2) M^T of the paper is the nearest rotation to M^T.
    rotation = nearest_rotation(pairs.turned_a.T @ pairs.turned_b)
    mount_from_cam = SE3(rotation, mount_translation(pairs, rotation))
    return mount_from_cam, mean_pose(mount_from_far.inverse() @ mount_from_cam @ cam_from_board)
