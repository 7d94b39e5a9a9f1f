"""Nonlinear refinement: Levenberg-Marquardt with the Schur complement over views."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.normal_equations import NormalEquations, normal_equations
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.state import State
from vision_robot.errors import NoConvergence
from vision_robot.types import Array, Float

__all__ = ["Refinement", "arrow_solve", "refine", "schur_complement"]


DAMPED_OUT = 1e18
"""Damping past which no step is left."""

EXACT_PX = 1e-11
"""Residuals of this size [px] are rounding: the corners were made without noise."""


@dataclass(frozen=True)
class Refinement:
    """Where the descent ended."""

    state: State
    equations: NormalEquations
    iterations: int


def refine(
    state: State,
    problem: Problem,
    *,
    max_iterations: int = 100,
    tolerance: float = 3e-3,
) -> Refinement:
    """Minimise the reprojection error over the free shared parameters and all poses.

    Ends when the next step would move the estimate by less than `tolerance` of its own
    standard deviation, up to a hundred parameters together (damping after Nielsen 1999). Raises
    NoConvergence when that has not come about after `max_iterations`.
    """
    equations = normal_equations(state, problem)
    dof = max(problem.degrees_of_freedom, 1)
    # Thousands of poses share what a hundred parameters are allowed together.
    allowed = tolerance**2 * max(1.0, (int(problem.free.sum()) + 6 * problem.seen.views) / 100)
    damping, growth = 1e-8, 2.0
    for iteration in range(max_iterations):
        variance = 2 * equations.cost / dof
        step = _step(state, equations, problem.free, damping)
        if step is not None:
            candidate, predicted = step
            # 2 predicted = step^T H step, the length of the step measured in standard deviations.
            settled = 2 * predicted <= allowed * variance or variance <= EXACT_PX**2
            if settled and damping < 1e-2:
                return Refinement(state, equations, iteration)
            trial = normal_equations(candidate, problem)
            gained = equations.cost - trial.cost
            if gained > 0:
                state, equations = candidate, trial
                damping = max(damping * max(1 / 30, 1 - (2 * gained / predicted - 1) ** 3), 1e-12)
                growth = 2.0
                continue
            if predicted <= 1e-12 * equations.cost:
                return Refinement(state, equations, iteration)  # rounding decides the sign now
        damping, growth = max(damping, 1e-6) * growth, growth * 2
        if damping > DAMPED_OUT:
            break
    raise NoConvergence(
        f"the calibration did not settle within {max_iterations} iterations: "
        "a simpler --model, more views or a better start is needed"
    )


def _step(
    state: State, equations: NormalEquations, free: Array, damping: float
) -> tuple[State, float] | None:
    """The damped step and the decrease that the quadratic model predicts; None where there is none."""
    try:
        shared_step, pose_step = arrow_solve(equations, damping)
    except np.linalg.LinAlgError:
        return None
    predicted = _predicted_decrease(equations, shared_step, pose_step)
    if not (np.isfinite(predicted) and predicted > 0):
        return None
    candidate = state.moved(free, shared_step, pose_step)
    return None if candidate is None else (candidate, predicted)


def arrow_solve(
    equations: NormalEquations, damping: float = 0.0
) -> tuple[Float[Array, "p"], Float[Array, "views 6"]]:
    """Gauss-Newton step (shared, poses), Marquardt's diagonal scaled by `damping`."""
    pose = equations.pose + damping * _diagonal(equations.pose)
    rhs = np.concatenate([equations.border.transpose(0, 2, 1), equations.pose_gradient[..., None]], axis=2)
    solved = np.linalg.solve(pose, rhs)
    inverse_border, inverse_gradient = solved[..., :-1], solved[..., -1]
    p = len(equations.shared)
    reduced = equations.shared + damping * _diagonal(equations.shared[None])[0]
    reduced = reduced - np.tensordot(equations.border, inverse_border, axes=([0, 2], [0, 1]))
    gradient = equations.shared_gradient - np.tensordot(
        equations.border, inverse_gradient, axes=([0, 2], [0, 1])
    )
    shared_step = np.zeros(0)
    if p:
        # Intrinsics span eight orders of magnitude: solve with unit diagonal.
        scale = 1 / np.sqrt(np.maximum(np.diag(equations.shared), 1e-300))
        shared_step = -scale * np.linalg.solve(reduced * scale[:, None] * scale, scale * gradient)
    pose_step = -inverse_gradient - inverse_border @ shared_step
    return shared_step, pose_step


def schur_complement(equations: NormalEquations) -> Float[Array, "p p"]:
    """Information on the shared parameters once the poses are free to follow."""
    inverse_border = np.linalg.solve(equations.pose, equations.border.transpose(0, 2, 1))
    return equations.shared - np.tensordot(equations.border, inverse_border, axes=([0, 2], [0, 1]))


def _diagonal(matrices: Float[Array, "n k k"]) -> Float[Array, "n k k"]:
    return np.eye(matrices.shape[-1]) * np.diagonal(matrices, axis1=1, axis2=2)[:, None, :]


def _predicted_decrease(equations: NormalEquations, shared: Array, pose: Array) -> float:
    linear = equations.shared_gradient @ shared + np.sum(equations.pose_gradient * pose)
    coupling = np.einsum("vpk,p,vk->", equations.border, shared, pose)
    own = np.einsum("vk,vkl,vl->", pose, equations.pose, pose)
    return float(-(linear + 0.5 * (shared @ equations.shared @ shared + own) + coupling))
