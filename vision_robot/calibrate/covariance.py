"""How well a calibration knows what it says."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.normal_equations import NormalEquations
from vision_robot.calibrate.refine import schur_complement
from vision_robot.types import Array, Bool, Float

__all__ = ["Covariance", "covariance"]

NULL = 3e-14
"""Eigenvalues of the scaled Schur complement below this are rounding."""


@dataclass(frozen=True)
class Covariance:
    """Joint covariance of the shared parameters and each view's pose.

    `intrinsics` (p, p) follows Camera.parameters, with zeros for fixed ones; `poses`
    (views, 6, 6) is that of the perturbation (w [rad], dt [m]) with R <- Exp(w) R and
    t <- t + dt; `cross` (views, p, 6) ties the two. Scaled by the noise found in the
    residuals.
    """

    intrinsics: Float[Array, "p p"]
    poses: Float[Array, "views 6 6"]
    cross: Float[Array, "views p 6"]
    undetermined: tuple[str, ...] = ()
    """Names of parameters that the views leave free; their entries mean nothing."""

    @property
    def sigma(self) -> Float[Array, "p"]:
        """One standard deviation of each intrinsic parameter."""
        return np.sqrt(np.diag(self.intrinsics))


def covariance(
    equations: NormalEquations, free: Bool[Array, "p"], names: Sequence[str], variance: float
) -> Covariance:
    """Inverse of the Gauss-Newton matrix times the variance of unit weight (Triggs et al. 2000, app. B).

    `names` are those of all p parameters. Directions in the null space are left out of
    the inverse, and the parameters that take part in them are named, not numbered.
    """
    S = schur_complement(equations)
    # Scaled by the information before the poses were set free, the eigenvalues say which
    # share of it is left; what is lost to rounding is lost.
    scale = 1 / np.sqrt(np.maximum(np.diag(equations.shared), 1e-300))
    values, vectors = np.linalg.eigh(S * scale[:, None] * scale)
    null = values < NULL
    inverse = (vectors[:, ~null] / values[~null]) @ vectors[:, ~null].T * scale[:, None] * scale
    involved = np.abs(vectors[:, null]).max(axis=1, initial=0) > 0.1

    pose_inverse = np.linalg.inv(equations.pose)
    gain = equations.border @ pose_inverse  # views, free, 6
    cross = -inverse @ gain
    poses = pose_inverse - gain.transpose(0, 2, 1) @ cross

    p, views = len(free), len(equations.pose)
    full = np.zeros((p, p))
    full[np.ix_(free, free)] = inverse
    full_cross = np.zeros((views, p, 6))
    full_cross[:, free] = cross
    lost = tuple(names[int(i)] for i in np.flatnonzero(free)[involved])
    return Covariance(variance * full, variance * poses, variance * full_cross, lost)
