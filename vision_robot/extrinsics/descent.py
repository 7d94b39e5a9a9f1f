"""Levenberg-Marquardt over anything that can be moved by a step."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar, runtime_checkable

import numpy as np

from vision_robot.errors import NoConvergence
from vision_robot.types import Array, Float

__all__ = ["DenseEquations", "Descent", "dense_step", "descend"]


@runtime_checkable
class Equations(Protocol):
    """Normal equations of half a weighted sum of squares."""

    @property
    def cost(self) -> float:
        """Half the sum; infinite where the state explains nothing."""
        ...


State = TypeVar("State")
Found = TypeVar("Found", bound=Equations)
Step = TypeVar("Step")


@dataclass(frozen=True)
class Descent(Generic[State, Found]):
    """Where a descent ended, and the equations there."""

    state: State
    equations: Found
    iterations: int


@dataclass(frozen=True)
class DenseEquations:
    """Cost, gradient and Gauss-Newton matrix of a few unknowns."""

    cost: float
    gradient: Float[Array, "k"]
    matrix: Float[Array, "k k"]

    @classmethod
    def of(cls, jacobian: Float[Array, "n k"], residual: Float[Array, "n"]) -> "DenseEquations":
        """From a weighted Jacobian and residual; infinite cost where one of them is not finite."""
        if not (np.isfinite(residual).all() and np.isfinite(jacobian).all()):
            k = jacobian.shape[1]
            return cls(np.inf, np.zeros(k), np.eye(k))
        return cls(0.5 * float(residual @ residual), jacobian.T @ residual, jacobian.T @ jacobian)


def dense_step(equations: DenseEquations, damping: float) -> tuple[Float[Array, "k"], float]:
    """The damped Gauss-Newton step and the decrease the quadratic model foretells.

    Unknowns of very different size are brought to one scale first.
    """
    scale = 1 / np.sqrt(np.maximum(np.diag(equations.matrix), 1e-300))
    scaled = equations.matrix * scale[:, None] * scale
    step = -scale * np.linalg.solve(scaled + damping * np.eye(len(scale)), scale * equations.gradient)
    return step, float(-(equations.gradient @ step + 0.5 * step @ equations.matrix @ step))


def descend(
    state: State,
    *,
    evaluate: Callable[[State], Found],
    solve: Callable[[Found, float], tuple[Step, float]],
    move: Callable[[State, Step], State | None],
    variance: Callable[[Found], float],
    what: str,
    max_iterations: int = 100,
    tolerance: float = 3e-3,
) -> Descent[State, Found]:
    """Minimise from `state`; damping after Nielsen (1999).

    Ends when the next step would move the estimate by less than `tolerance` of its own standard
    deviation, with the `variance` of unit weight that the cost tells. Raises NoConvergence, naming
    `what` was sought.
    """
    equations = evaluate(state)
    damping, growth = 1e-8, 2.0
    for iteration in range(max_iterations):
        unit = variance(equations)
        try:
            step, predicted = solve(equations, damping)
        except np.linalg.LinAlgError:
            step, predicted = None, -1.0
        if step is not None and np.isfinite(predicted) and predicted >= 0:
            # 2 predicted = step^T H step, the length of the step measured in standard deviations.
            if damping < 1e-2 and (2 * predicted <= tolerance**2 * unit or unit <= EXACT**2):
                return Descent(state, equations, iteration)
            candidate = move(state, step)
            trial = evaluate(candidate) if candidate is not None else None
            if candidate is not None and trial is not None and equations.cost > trial.cost:
                gained = equations.cost - trial.cost
                state, equations = candidate, trial
                damping = max(damping * max(1 / 30, 1 - (2 * gained / predicted - 1) ** 3), 1e-12)
                growth = 2.0
                continue
            if predicted <= 1e-12 * equations.cost:
                return Descent(state, equations, iteration)  # rounding decides the sign now
        damping, growth = max(damping, 1e-6) * growth, growth * 2
        if damping > DAMPED_OUT:
            break
    raise NoConvergence(f"{what} did not settle within {max_iterations} iterations")


DAMPED_OUT = 1e18
"""Damping past which no step is left."""

EXACT = 1e-11
"""Weighted residuals of this size are rounding: the data were made without noise."""
