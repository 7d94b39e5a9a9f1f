"""From what `vr extrinsics hand-eye` was given to everything it can say."""

from dataclasses import dataclass

from vision_robot.calibrate.hand_eye import (
    GeometryTolerance,
    HandEyeResult,
    HandEyeSettings,
    calibrate_hand_eye,
)
from vision_robot.calibrate.hand_eye.judgement import HandEyeJudgement, judge_hand_eye
from vision_robot_cli.hand_eye_input import HandEyeInput, HandEyeOptions

__all__ = ["HandEyeVerdict", "solved"]


@dataclass(frozen=True)
class HandEyeVerdict:
    """A hand-eye calibration and how far to believe it."""

    result: HandEyeResult
    judgement: HandEyeJudgement


def solved(given: HandEyeInput, asked: HandEyeOptions, seed: int) -> HandEyeVerdict:
    """Calibrate and judge."""
    settings = HandEyeSettings(
        setup=asked.setup,
        geometry=GeometryTolerance() if asked.geometry else None,
        free_camera=asked.intrinsics == "free",
    )
    result = given.timed(
        "solve",
        lambda: calibrate_hand_eye(
            given.corners,
            given.poses,
            given.points,
            given.camera,
            settings,
            arm=given.arm,
            joints=given.joints,
            rejected=given.rejected,
        ),
    )
    judgement = given.timed("judge", lambda: judge_hand_eye(result, arm=given.arm, seed=seed))
    return HandEyeVerdict(result, judgement)
