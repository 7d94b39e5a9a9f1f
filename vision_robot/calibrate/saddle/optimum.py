"""Levenberg-Marquardt for many small problems at once."""

from dataclasses import dataclass, fields

import numpy as np

from vision_robot.calibrate.saddle.problem import GEOMETRY, SaddleProblem
from vision_robot.types import Array, Float

__all__ = ["Optimum", "optimum"]

SHARPEST = np.sqrt(12.0)
"""The pixel's own extent is a blur of 1/√12 px: nothing is sharper."""

SHARPNESS_SETTLED = 0.05
MOST_STEPS = 12

QUANTISATION = 1 / 12
"""Variance of rounding to whole grey levels."""


@dataclass(frozen=True)
class Optimum:
    """Where the fits of n corners ended.

    `theta` as in SaddleProblem; `normal` JᵀWJ and `spread` JᵀW²J; `variance` (n,) of the samples, from
    the residuals, so that what the model does not explain counts as noise; `radius` (n,) as there.
    """

    theta: Float[Array, "n p"]
    normal: Float[Array, "n p p"]
    spread: Float[Array, "n p p"]
    variance: Float[Array, "n"]
    radius: Float[Array, "n"]

    @property
    def sharpness(self) -> Float[Array, "n 2 2"]:
        """Normals of the two edges over the blur across them [1/px]."""
        return self.theta[:, 2:GEOMETRY].reshape(-1, 2, 2)

    @property
    def blur(self) -> Float[Array, "n"]:
        """Geometric mean of the blur across the two edges [px]."""
        return np.linalg.norm(self.sharpness, axis=2).prod(axis=1) ** -0.5

    @classmethod
    def joined(cls, parts: list["Optimum"], order: Array) -> "Optimum":
        """Parts put together so that row i of the parts becomes row ``order[i]``."""
        back = np.argsort(order)
        return cls(*(np.concatenate([getattr(p, f.name) for p in parts])[back] for f in fields(cls)))


def optimum(problem: SaddleProblem, theta: Float[Array, "n p"], *, settled_px: float) -> Optimum:
    """Least squares from `theta`; a corner is done when its last step was below `settled_px`.

    Corners that are done leave the batch, so the slow ones cost little.
    """
    n, p = theta.shape
    theta = theta.copy()
    J, r = problem.linearised(theta)
    N, g = _normal_equations(J, r)
    cost = (r * r).sum(axis=1)
    damping, busy, part = np.full(n, 1e-4), np.arange(n), problem
    for _ in range(MOST_STEPS):
        step = _damped_step(N[busy], g[busy], damping[busy])
        trial = _no_sharper_than_pixels(theta[busy] + step)
        J_trial, r_trial = part.linearised(trial)
        cost_trial = (r_trial * r_trial).sum(axis=1)
        better = cost_trial <= cost[busy] * (1 + 1e-6)
        a = busy[better]
        if len(a) == n:
            J, r = J_trial, r_trial
            N, g = _normal_equations(J, r)
        else:
            J[a], r[a] = J_trial[better], r_trial[better]
            N[a], g[a] = _normal_equations(J[a], r[a])
        theta[a], cost[a] = trial[better], cost_trial[better]
        damping[busy] *= np.where(better, 0.1, 10.0)
        settled = np.abs(step[:, :2]).max(axis=1) < settled_px
        turned = np.abs(step[:, 2:GEOMETRY]).max(axis=1)
        settled &= turned < SHARPNESS_SETTLED * np.abs(trial[:, 2:GEOMETRY]).max(axis=1)
        going = ~(better & settled) & (damping[busy] < 1e3)
        if not going.any():
            break
        if not going.all():
            busy, part = busy[going], part.take(going)
    weight = problem.weight
    spread = np.matmul(J * weight[:, None], J.transpose(0, 2, 1)).astype(float)
    freedom = np.maximum(weight.sum(axis=1) - p, 3)
    return Optimum(theta, N, spread, cost / freedom + QUANTISATION, problem.radius)


def _normal_equations(
    J: Float[Array, "n p m"], r: Float[Array, "n m"]
) -> tuple[Float[Array, "n p p"], Float[Array, "n p"]]:
    N = np.matmul(J, J.transpose(0, 2, 1)).astype(float)
    return N, np.matmul(J, r[:, :, None])[:, :, 0].astype(float)


def _damped_step(
    N: Float[Array, "n p p"], g: Float[Array, "n p"], damping: Float[Array, "n"]
) -> Float[Array, "n p"]:
    diagonal = np.einsum("nii->ni", N)
    # The absolute part keeps windows without any contrast solvable.
    lift = damping[:, None] * diagonal + 1e-9 * diagonal.max(axis=1, keepdims=True) + 1e-12
    return np.linalg.solve(N + lift[:, :, None] * np.eye(N.shape[1]), g[:, :, None])[:, :, 0]


def _no_sharper_than_pixels(theta: Float[Array, "n p"]) -> Float[Array, "n p"]:
    normals = theta[:, 2:GEOMETRY].reshape(-1, 2, 2)
    size = np.linalg.norm(normals, axis=2, keepdims=True).clip(1e-9)
    theta[:, 2:GEOMETRY] = (normals * np.minimum(1, SHARPEST / size)).reshape(-1, 4)
    return theta
