"""Everything a hand-eye calibration can be asked, in one go."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

from vision_robot.calibrate.hand_eye.judgement.board_scale import BoardScale, board_scale
from vision_robot.calibrate.hand_eye.judgement.error_budget import HandEyeBudget, hand_eye_budget
from vision_robot.calibrate.hand_eye.judgement.held_out import HeldOutViews, hold_out_views
from vision_robot.calibrate.hand_eye.judgement.next_pose import NextPoses, next_poses
from vision_robot.calibrate.hand_eye.judgement.verdict import advice, verdict
from vision_robot.calibrate.hand_eye.result import HandEyeResult
from vision_robot.calibrate.hand_eye.words import millimetres, short
from vision_robot.errors import VisionRobotError
from vision_robot.geometry import SerialChain

__all__ = ["HandEyeJudgement", "judge_hand_eye"]

Answer = TypeVar("Answer")


@dataclass(frozen=True)
class HandEyeJudgement:
    """Answers; those that the views cannot give are None, with the reason in `unanswered`."""

    held_out: HeldOutViews
    budget: HandEyeBudget
    scale: BoardScale
    next_poses: NextPoses | None
    verdict: str
    advice: tuple[str, ...]
    unanswered: dict[str, str] = field(default_factory=dict)

    @property
    def sentences(self) -> tuple[str, ...]:
        """What the answers say, in words."""
        held_out = self.held_out
        return (
            self.verdict,
            f"views held out, foretold from the arm's pose, err by {short(held_out.total_px)} px per corner, "
            f"{millimetres(held_out.total_m)} at the board; {short(held_out.ratio)} times what was foretold",
            *self.advice,
        )


def judge_hand_eye(
    result: HandEyeResult, *, arm: SerialChain | None = None, count: int = 3, seed: int = 0
) -> HandEyeJudgement:
    """Ask a hand-eye calibration everything.

    Args:
        result: The calibration.
        arm: The arm's model, for the limits that next poses keep.
        count: How many next poses.
        seed: Of the candidates drawn for them.
    """
    unanswered: dict[str, str] = {}

    def ask(name: str, question: Callable[[], Answer]) -> Answer | None:
        try:
            return question()
        except VisionRobotError as error:
            unanswered[name] = str(error)
            return None

    held_out, budget, scale = hold_out_views(result), hand_eye_budget(result), board_scale(result)
    return HandEyeJudgement(
        held_out=held_out,
        budget=budget,
        scale=scale,
        next_poses=ask("next poses", lambda: next_poses(result, arm=arm, count=count, seed=seed)),
        verdict=verdict(result, budget),
        advice=advice(result, held_out, scale, budget),
        unanswered=unanswered,
    )
