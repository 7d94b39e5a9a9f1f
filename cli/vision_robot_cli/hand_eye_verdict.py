"""From what `vr extrinsics hand-eye` was given to everything it can say."""

from dataclasses import dataclass
from pathlib import Path

from vision_robot.calibrate.hand_eye import (
    GeometryTolerance,
    HandEyeResult,
    HandEyeSettings,
    calibrate_hand_eye,
)
from vision_robot.calibrate.hand_eye.judgement import HandEyeJudgement, judge_hand_eye
from vision_robot.calibrate.hand_eye.tool_centre import ToolCentre, tool_centre
from vision_robot_cli.hand_eye_input import HandEyeInput, read_touches
from vision_robot_cli.hand_eye_options import HandEyeOptions

__all__ = ["HandEyeVerdict", "solved"]


@dataclass(frozen=True)
class HandEyeVerdict:
    """A hand-eye calibration and how far to believe it."""

    result: HandEyeResult
    judgement: HandEyeJudgement
    tool: ToolCentre | None = None


def solved(
    given: HandEyeInput, asked: HandEyeOptions, seed: int, touches: Path | None = None
) -> HandEyeVerdict:
    """Calibrate and judge; with touches find the tool centre too."""
    touched = read_touches(touches, asked, given.points) if touches else None
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
    return HandEyeVerdict(result, judgement, tool_centre(result, *touched) if touched else None)
