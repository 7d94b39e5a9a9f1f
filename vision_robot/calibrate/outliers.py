"""Corners that noise cannot explain: found by a robust fit and named, so that they can be left out."""

import numpy as np

from vision_robot.calibrate.normal_equations import residuals
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.refine import refine
from vision_robot.calibrate.state import State
from vision_robot.errors import NoConvergence
from vision_robot.types import Array, Bool, Float

__all__ = ["CUTOFF", "VIEW_SHARE", "explained"]

CUTOFF = 5.5
"""Residual length, in robust standard deviations per axis, past which a corner is an outlier.

Gaussian noise alone reaches it once in 3.7 million corners (Rayleigh's tail exp(-c^2 / 2)).
"""

NEVER_OUTLYING_PX = 0.1
"""A corner nearer than this is kept whatever the noise: on very clean pictures the small errors that
edges and print leave are no longer Gaussian, and harm less than leaving them out."""

VIEW_SHARE = 0.3
"""A view with a larger share of outliers is an outlier itself."""

RAYLEIGH_MEDIAN = 1.1774
CAUCHY_TUNING = 2.385
"""Makes the Cauchy estimate 95 % as efficient as least squares on Gaussian noise (Zhang 1997)."""


def explained(state: State, problem: Problem, *, rounds: int = 15) -> Bool[Array, "views n"]:
    """Which corners a robust fit from `state` explains; false in the padding."""
    seen = problem.seen
    length, scale = _lengths(state, problem)
    if not _outlying(length, scale, seen).any():
        return seen.present
    for _ in range(rounds):
        pull = 1 / np.sqrt(1 + (length / (CAUCHY_TUNING * scale)) ** 2)
        try:
            state = refine(state, problem.of(seen.with_weight(seen.weight * pull)), tolerance=0.1).state
        except NoConvergence:
            break
        previous = scale
        length, scale = _lengths(state, problem)
        if abs(scale / previous - 1) < 0.01:
            break
    keep = seen.present & ~_outlying(length, scale, seen)
    crowd = seen.present.sum(axis=1)
    return keep & (keep.sum(axis=1) >= (1 - VIEW_SHARE) * crowd)[:, None]


def _outlying(length: Array, scale: float, seen: Observations) -> Bool[Array, "views n"]:
    return (length > CUTOFF * scale) & (length > NEVER_OUTLYING_PX * seen.weight)


def _lengths(state: State, problem: Problem) -> tuple[Float[Array, "views n"], float]:
    """Weighted residual lengths, zero in the padding, and their robust standard deviation per axis."""
    length = np.linalg.norm(residuals(state, problem.seen), axis=1) * problem.seen.weight
    scale = float(np.median(length[problem.seen.present])) / RAYLEIGH_MEDIAN
    return length, max(scale, 1e-9)
