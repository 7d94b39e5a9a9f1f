"""The joint descent: Levenberg-Marquardt with the views' poses eliminated."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.equations import hand_eye_equations
from vision_robot.calibrate.hand_eye.problem import HandEyeProblem
from vision_robot.calibrate.hand_eye.state import HandEyeState
from vision_robot.calibrate.normal_equations import NormalEquations
from vision_robot.calibrate.refine import arrow_solve
from vision_robot.errors import NoConvergence

__all__ = ["HandEyeEnd", "refine_hand_eye"]

DAMPED_OUT = 1e18
"""Damping past which no step is left."""


@dataclass(frozen=True)
class HandEyeEnd:
    """Where the descent ended."""

    state: HandEyeState
    equations: NormalEquations
    iterations: int


def refine_hand_eye(
    state: HandEyeState, problem: HandEyeProblem, *, max_iterations: int = 60, tolerance: float = 3e-3
) -> HandEyeEnd:
    """Minimise over all unknowns.

    Ends when the next step would move the estimate by less than `tolerance` of its own standard
    deviation, up to a hundred unknowns together (damping after Nielsen 1999). Raises NoConvergence
    when that has not come about after `max_iterations`.
    """
    equations = hand_eye_equations(state, problem)
    unknowns = len(equations.shared) + 6 * len(equations.pose)
    allowed = tolerance**2 * max(1.0, unknowns / 100)
    damping, growth = 1e-9, 2.0
    for iteration in range(max_iterations):
        step = arrow_solve(equations, damping)
        predicted = _predicted(equations, *step, damping)
        if np.isfinite(predicted) and predicted >= 0:
            if 2 * predicted <= allowed and damping < 1e-2:
                return HandEyeEnd(state, equations, iteration)
            candidate = state.moved(problem.free, *step)
            if candidate is not None:
                trial = hand_eye_equations(candidate, problem)
                gained = equations.cost - trial.cost
                if gained > 0:
                    state, equations = candidate, trial
                    ratio = 2 * gained / max(predicted, 1e-300) - 1
                    damping = max(damping * max(1 / 30, 1 - min(ratio, 1) ** 3), 1e-12)
                    growth = 2.0
                    continue
                if predicted <= 1e-11 * equations.cost:
                    return HandEyeEnd(state, equations, iteration)  # rounding decides the sign now
        damping, growth = max(damping, 1e-6) * growth, growth * 2
        if damping > DAMPED_OUT:
            break
    raise NoConvergence(
        f"the hand-eye calibration did not settle within {max_iterations} iterations: "
        "the arm's poses and the pictures contradict each other"
    )


def _predicted(e: NormalEquations, shared: np.ndarray, poses: np.ndarray, damping: float) -> float:
    """The decrease of the quadratic model: half of what the gradient promises, and of the damping."""
    linear = e.shared_gradient @ shared + np.sum(e.pose_gradient * poses)
    held = np.diag(e.shared) @ shared**2 + np.sum(np.diagonal(e.pose, axis1=1, axis2=2) * poses**2)
    return float(-0.5 * linear + 0.5 * damping * held)
