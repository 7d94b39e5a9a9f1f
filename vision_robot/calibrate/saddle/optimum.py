"""Levenberg-Marquardt for many small problems at once."""

from dataclasses import dataclass, fields
from typing import Protocol, runtime_checkable

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

    `theta` as in SaddleProblem; `normal` JᵀWJ and the prior; `variance` (n,) of the samples, from the
    residuals, so that what the model does not explain counts as noise; `radius` (n,) as in SaddleProblem.
    """

    theta: Float[Array, "n p"]
    normal: Float[Array, "n p p"]
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


@runtime_checkable
class Prior(Protocol):
    """What is known of the parameters beforehand, as least squares too."""

    def take(self, some: Array) -> "Prior":
        """The prior of some of the corners."""
        ...

    def terms(
        self, theta: Float[Array, "n p"]
    ) -> tuple[Float[Array, "n p p"], Float[Array, "n p"], Float[Array, "n"]]:
        """What it adds to the normal matrix, to the gradient's negative and to the cost."""
        ...


def optimum(
    problem: SaddleProblem, theta: Float[Array, "n p"], *, settled_px: float, prior: Prior | None = None
) -> Optimum:
    """Least squares from `theta`; a corner is done when its last step was below `settled_px`.

    Corners that are done leave the batch, so the slow ones cost little.
    """
    n, p = theta.shape
    theta = theta.copy()
    N, g, cost = _evaluated(problem, theta, prior)
    damping, busy, part = np.full(n, 1e-4), np.arange(n), problem
    for _ in range(MOST_STEPS):
        step = _damped_step(N[busy], g[busy], damping[busy])
        trial = _no_sharper_than_pixels(theta[busy] + step)
        N_trial, g_trial, cost_trial = _evaluated(part, trial, prior)
        better = cost_trial <= cost[busy] * (1 + 1e-6)
        a = busy[better]
        theta[a], cost[a] = trial[better], cost_trial[better]
        N[a], g[a] = N_trial[better], g_trial[better]
        damping[busy] *= np.where(better, 0.1, 10.0)
        settled = np.abs(step[:, :2]).max(axis=1) < settled_px
        turned = np.abs(step[:, 2:GEOMETRY]).max(axis=1)
        settled &= turned < SHARPNESS_SETTLED * np.abs(trial[:, 2:GEOMETRY]).max(axis=1)
        going = ~(better & settled) & (damping[busy] < 1e3)
        if not going.any():
            break
        if not going.all():
            busy, part = busy[going], part.take(going)
            prior = prior and prior.take(going)
    freedom = np.maximum(problem.weight.sum(axis=1) - p, 3)
    return Optimum(theta, N, cost / freedom + QUANTISATION, problem.radius)


def _evaluated(
    problem: SaddleProblem, theta: Float[Array, "n p"], prior: Prior | None
) -> tuple[Float[Array, "n p p"], Float[Array, "n p"], Float[Array, "n"]]:
    """Normal matrix, negative gradient and cost."""
    J, r = problem.linearised(theta)
    N = np.matmul(J, J.transpose(0, 2, 1)).astype(float)
    g = np.matmul(J, r[:, :, None])[:, :, 0].astype(float)
    cost = (r * r).sum(axis=1).astype(float)
    if prior is None:
        return N, g, cost
    more_N, more_g, more_cost = prior.terms(theta)
    return N + more_N, g + more_g, cost + more_cost


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
