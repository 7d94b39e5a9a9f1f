"""Hand-eye calibration: where a camera sits on an arm, or beside it, and how well that is known."""

from vision_robot.calibrate.hand_eye.arm import GeometryTolerance
from vision_robot.calibrate.hand_eye.problem import ArmNoise
from vision_robot.calibrate.hand_eye.result import HandEyeResult
from vision_robot.calibrate.hand_eye.settings import HandEyeSettings
from vision_robot.calibrate.hand_eye.solve import calibrate_hand_eye

__all__ = [
    "ArmNoise",
    "GeometryTolerance",
    "HandEyeResult",
    "HandEyeSettings",
    "calibrate_hand_eye",
]
