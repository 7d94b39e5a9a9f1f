"""How well a calibration knows what it says."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.normal_equations import NormalEquations
from vision_robot.calibrate.refine import schur_complement
from vision_robot.calibrate.state import State
from vision_robot.types import Array, Bool, Float

__all__ = ["Covariance", "covariance"]

NULL = 3e-14
"""Eigenvalues of the scaled Schur complement below this are rounding."""


@dataclass(frozen=True)
class Covariance:
    """Joint covariance of the shared parameters and each view's pose.

    `shared` (s, s) follows Camera.parameters, then the board's warp, with zeros for what
    was fixed; `poses` (views, 6, 6) is that of the perturbation (w [rad], dt [m]) with
    R <- Exp(w) R and t <- t + dt; `cross` (views, s, 6) ties the two. Scaled by the noise
    found in the residuals.
    """

    shared: Float[Array, "s s"]
    poses: Float[Array, "views 6 6"]
    cross: Float[Array, "views s 6"]
    intrinsic_count: int
    undetermined: tuple[str, ...] = ()
    """Names of parameters that the views leave free; their entries mean nothing."""

    @property
    def intrinsics(self) -> Float[Array, "p p"]:
        """The part of Camera.parameters."""
        return self.shared[: self.intrinsic_count, : self.intrinsic_count]

    @property
    def sigma(self) -> Float[Array, "p"]:
        """One standard deviation of each of Camera.parameters."""
        return np.sqrt(np.diag(self.intrinsics))


def covariance(
    equations: NormalEquations, free: Bool[Array, "s"], state: State, variance: float
) -> Covariance:
    """Inverse of the Gauss-Newton matrix times the variance of unit weight (Triggs et al. 2000, app. B).

    Directions in the null space are left out of
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
    lost = tuple(state.shared_names[int(i)] for i in np.flatnonzero(free)[involved])
    count = len(state.camera.parameters)
    return Covariance(variance * full, variance * poses, variance * full_cross, count, lost)
