"""What evaluates an arm's functions over many goals: numpy everywhere, compiled C where it can be had."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

from vision_robot.arm.closed_form import ClosedForm, closed_form_of
from vision_robot.arm.starts import Starts, start_table
from vision_robot.arm.symbolic import length_scale, lm_step, residual
from vision_robot.arm.task import Task
from vision_robot.errors import UnknownStructure
from vision_robot.geometry import SerialChain
from vision_robot.types import Array, Float, Int

if TYPE_CHECKING:
    from casadi import Function

__all__ = ["CLOSE", "Engine", "Program", "program_of"]

CLOSE = (1e-6, 1e-6)
"""Distance [m] and angle [rad] of the goal from which one more step, squaring them, is the last."""

PATIENCE = 0.1
"""Damping of the second search."""

Rows = Float[Array, "goals 12"]


@dataclass(frozen=True)
class Program:
    """Everything about one arm and one task that an engine runs."""

    chain: SerialChain
    step: "Function"
    patient_step: "Function"
    """More strongly damped: slower, and sure where a goal lies at the border of what can be reached."""
    error: "Function"
    starts: Starts
    scale: float
    closed: ClosedForm | None
    unknown: UnknownStructure | None = None
    """Why there is no closed form."""


def program_of(chain: SerialChain, task: Task, nominal: SerialChain | None = None) -> Program:
    """The functions of an arm; its closed form, where it has one, that of `nominal` where that is given."""
    import casadi as ca

    q, goal = ca.SX.sym("q", len(chain)), ca.SX.sym("goal", 12)
    error = ca.Function(
        "pose_error", [q, goal], [residual(chain, task)(q, goal)[2]], ["q", "goal"], ["error"]
    )
    closed, unknown = None, None
    try:
        closed = closed_form_of(nominal or chain, task=task)
    except UnknownStructure as refusal:
        unknown = refusal
    return Program(
        chain,
        lm_step(chain, task),
        _renamed(lm_step(chain, task, damping=PATIENCE)),
        error,
        start_table(chain, task),
        length_scale(chain),
        closed,
        unknown,
    )


def _renamed(function: "Function") -> "Function":
    import casadi as ca

    symbols = function.sx_in()
    results = list(function.call(symbols))
    return ca.Function("patient_step", symbols, results, function.name_in(), function.name_out())


class Engine(ABC):
    """Evaluates a program over many goals on the calling thread."""

    name: str

    @abstractmethod
    def numeric(
        self,
        goals: Rows,
        *,
        first: Float[Array, "goals n"] | None,
        tries: int,
        iterations: int,
        patient: bool = False,
    ) -> Float[Array, "goals n"]:
        """Joint values by damped Gauss-Newton: from `first`, then from the starts, nearest first.

        `patient` takes the strongly damped step. What comes close to no goal in `tries` starts of
        `iterations` steps gets the best that was seen.
        """

    @abstractmethod
    def errors(self, goals: Rows, q: Float[Array, "goals n"]) -> Float[Array, "goals 2"]:
        """Distance [m] and angle [rad] from each goal."""

    @abstractmethod
    def closed(
        self, goals: Rows
    ) -> tuple[Float[Array, "goals branches n"], Float[Array, "goals branches 2"]]:
        """All branches of the closed form and their errors."""

    @abstractmethod
    def choose(
        self,
        goals: Rows,
        *,
        near: Float[Array, "rows n"],
        weights: Float[Array, "n"],
        periods: Float[Array, "n"],
        tolerance: tuple[float, float],
    ) -> tuple[Float[Array, "goals n"], Float[Array, "goals 2"], Int[Array, "goals"]]:
        """The closed form's branch nearest to `near` (one row, or one a goal) within limits and tolerance.

        Nearest by the weighted sum of squares, each joint with a period turned towards `near` by whole ones.
        Joint values, errors and the branch; -1, with the one that misses least, where none is right.
        """
