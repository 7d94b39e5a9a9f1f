"""From what `vr calibrate` was given to everything it can say."""

from collections.abc import Sequence
from dataclasses import dataclass

from vision_robot.calibrate import CalibrationResult, Corners, Settings, calibrate
from vision_robot.calibrate.circle_bias import calibrate_circles
from vision_robot.calibrate.judgement import Judgement, judge
from vision_robot.calibrate.judgement.selection import Selection, select
from vision_robot_cli.calibration_input import CalibrationInput

__all__ = ["Verdict", "reached"]


@dataclass(frozen=True)
class Verdict:
    """A calibration, how far to believe it, and how its model was chosen where that was left open."""

    result: CalibrationResult
    judgement: Judgement
    selection: Selection | None = None


def reached(given: CalibrationInput, candidates: Sequence[Settings], seed: int) -> Verdict:
    """Choose among the candidates where there are several, calibrate, and judge."""
    settings, selection = candidates[0], None
    if len(candidates) > 1:
        selection = given.timed(
            "select", lambda: select(given.corners, given.points, given.size, candidates, seed=seed)
        )
        settings = selection.chosen

    def solve(corners: Sequence[Corners]) -> CalibrationResult:
        return calibrate(corners, given.points, given.size, settings, rejected=given.rejected)

    discs = given.discs
    result = given.timed(
        "solve", lambda: calibrate_circles(given.corners, discs, solve) if discs else solve(given.corners)
    )
    partial = given.board is not None and given.board.allows_partial_views
    judgement = given.timed("judge", lambda: judge(result, given.points, partial=partial, seed=seed))
    return Verdict(result, judgement, selection)
