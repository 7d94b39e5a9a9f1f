"""How far a calibration can be believed: everything that asks, in one go."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

from vision_robot.calibrate.judgement.bootstrap import Bootstrap, bootstrap
from vision_robot.calibrate.judgement.error_budget import ErrorBudget, error_budget
from vision_robot.calibrate.judgement.halves import Halves, compare_halves
from vision_robot.calibrate.judgement.held_out import HeldOut, hold_back
from vision_robot.calibrate.judgement.influence import Influence, influence
from vision_robot.calibrate.judgement.next_view import NextViews, next_views
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.errors import VisionRobotError
from vision_robot.types import Array, Float

__all__ = ["Judgement", "judge"]

Answer = TypeVar("Answer")

BOOTSTRAP_UP_TO = 200
"""Views up to which the views are drawn anew; larger sets are sure of their own scatter."""


@dataclass(frozen=True)
class Judgement:
    """Answers, None where the views do not carry one; `unanswered` then says why, by name."""

    held_out: HeldOut | None
    halves: Halves | None
    influence: Influence | None
    bootstrap: Bootstrap | None
    error_budget: ErrorBudget | None
    next_views: NextViews | None
    unanswered: dict[str, str] = field(default_factory=dict)

    @property
    def sentences(self) -> tuple[str, ...]:
        """What the answers say, in words."""
        said = []
        if self.held_out:
            said.append(
                f"on views held out the error is {self.held_out.rms_px:.3g} px rms per point "
                f"(standard error {self.held_out.standard_error_px:.2g} px)"
            )
        if self.halves:
            said.append(self.halves.sentence)
        if self.bootstrap:
            said.append(self.bootstrap.sentence)
        if self.influence:
            said += self.influence.sentences
        return tuple(said)


def judge(
    result: CalibrationResult, board_points: Float[Array, "m 3"], *, partial: bool = False, seed: int = 0
) -> Judgement:
    """Ask a calibration everything; a question that its views cannot answer is left open, with the reason.

    Args:
        result: The calibration.
        board_points: Board points (m, 3) [m] as given to `calibrate`.
        partial: Whether a part of the board is enough for a view (coded targets).
        seed: Of the splits and draws.
    """
    unanswered: dict[str, str] = {}

    def ask(name: str, question: Callable[[], Answer]) -> Answer | None:
        try:
            return question()
        except VisionRobotError as error:
            unanswered[name] = str(error)
            return None

    few = len(result.corners) <= BOOTSTRAP_UP_TO
    return Judgement(
        held_out=ask("held out", lambda: hold_back(result, board_points, seed=seed)),
        halves=ask("halves", lambda: compare_halves(result, board_points, seed=seed)),
        influence=ask("influence", lambda: influence(result, board_points)),
        bootstrap=ask("bootstrap", lambda: bootstrap(result, board_points, seed=seed)) if few else None,
        error_budget=ask("error budget", lambda: error_budget(result, board_points)),
        next_views=ask("next views", lambda: next_views(result, board_points, whole=not partial)),
        unanswered=unanswered,
    )
