"""How far a hand-eye calibration can be believed, what makes its error, and where to go next."""

from vision_robot.calibrate.hand_eye.judgement.judge import HandEyeJudgement, judge_hand_eye

__all__ = ["HandEyeJudgement", "judge_hand_eye"]
