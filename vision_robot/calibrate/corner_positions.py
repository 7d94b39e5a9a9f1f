"""Where the corners of a calibration stand before the camera."""

import numpy as np

from vision_robot.calibrate.result import CalibrationResult
from vision_robot.geometry import plane_from_pixels
from vision_robot.types import Array, Float

__all__ = ["corners_in_cam"]


def corners_in_cam(result: CalibrationResult, view: int, *, every: int = 1) -> Float[Array, "n 3"]:
    """Corners of one view in the camera frame [m]: their predicted pixels met with the board's plane.

    Every n-th corner where `every` is n; rows are NaN where the lens model has no ray.
    """
    pose = result.cam_from_board[view]
    predicted = (result.corners[view].pixels + result.residuals[view])[::every]
    on_plane = plane_from_pixels(result.camera, pose, predicted)
    return pose.apply(np.column_stack([on_plane, np.zeros(len(on_plane))]))
