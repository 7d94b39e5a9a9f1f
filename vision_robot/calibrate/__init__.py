"""Camera calibration: boards, corners, Zhang's closed form, refinement and its covariance."""

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.covariance import Covariance
from vision_robot.calibrate.result import CalibrationResult, Rejected
from vision_robot.calibrate.settings import Settings
from vision_robot.calibrate.solve import calibrate
from vision_robot.calibrate.warp import Warp

__all__ = ["CalibrationResult", "Corners", "Covariance", "Rejected", "Settings", "Warp", "calibrate"]
