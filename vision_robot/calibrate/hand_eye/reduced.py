"""The problem seen from the arm: what its poses should have been, with the pictures' own error.

Once the views' poses follow the corners, each view is left with six numbers,
``d_i = r_i + E_i b_i`` (b_i the step of its pose to where the corners put it), which are
``-H_i theta`` and noise of covariance ``C_i + diag(arm's variances)``; C_i is what corners leave open.
This is the same linear model as the Schur complement (Woodbury), in the form in which the arm's
variances can be estimated.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.arm_residuals import arm_rows
from vision_robot.calibrate.hand_eye.equations import corner_equations
from vision_robot.calibrate.hand_eye.problem import ArmNoise, HandEyeProblem
from vision_robot.calibrate.hand_eye.state import HandEyeState
from vision_robot.types import Array, Float

__all__ = ["Reduced", "Weighed", "reduced"]


@dataclass(frozen=True)
class Reduced:
    """Residual, design and picture covariance of each view, and the priors on the shared unknowns.

    Shared: free camera parameters, (w, dt) of base_from_fixed, (w, dt) of wrist_from_carried, the arm's own.
    """

    residual: Float[Array, "views 6"]
    design: Float[Array, "views 6 s"]
    by_pictures: Float[Array, "views 6 6"]
    prior: Float[Array, "s s"]
    prior_gradient: Float[Array, "s"]

    def weighed(self, noise: ArmNoise) -> "Weighed":
        """Solved for that noise of the arm."""
        V = self.by_pictures + np.diag(np.repeat(noise.variances, 3))
        W = np.linalg.inv(V)
        WH = W @ self.design
        normal = np.einsum("vik,vil->kl", self.design, WH) + self.prior
        scale = 1 / np.sqrt(np.maximum(np.diag(normal), 1e-300))
        inverse = np.linalg.pinv(normal * scale[:, None] * scale, rcond=1e-15, hermitian=True)
        inverse = inverse * scale[:, None] * scale
        gradient = np.einsum("vik,vi->k", WH, self.residual) + self.prior_gradient
        step = -inverse @ gradient
        return Weighed(self, W, WH, inverse, step, self.residual + self.design @ step)

    def keeping(self, views: Array) -> "Reduced":
        """Some of the views."""
        return Reduced(
            self.residual[views], self.design[views], self.by_pictures[views], self.prior, self.prior_gradient
        )


@dataclass(frozen=True)
class Weighed:
    """A reduced problem with its generalised least-squares solution."""

    of: Reduced
    weight: Float[Array, "views 6 6"]
    weighed_design: Float[Array, "views 6 s"]
    covariance: Float[Array, "s s"]
    """Of the shared unknowns."""
    step: Float[Array, "s"]
    left: Float[Array, "views 6"]
    """Residuals after the step."""


def reduced(state: HandEyeState, problem: HandEyeProblem) -> Reduced:
    """Eliminate the views' poses at `state`."""
    corners, rows = corner_equations(state, problem), arm_rows(state)
    inverse = np.linalg.inv(corners.pose)
    follow = -(inverse @ corners.pose_gradient[..., None])[..., 0]
    p, own = len(corners.shared), state.arm.values
    gain = rows.in_pose @ inverse
    design = np.concatenate([-gain @ np.swapaxes(corners.border, 1, 2), rows.in_shared], axis=2)
    s = design.shape[2]
    known, known_gradient, _ = problem.camera_prior(state.pictures.camera.parameters)
    prior, gradient = np.zeros((s, s)), np.zeros(s)
    folded = corners.border @ inverse
    prior[:p, :p] = corners.shared - np.einsum("vpk,vqk->pq", folded, corners.border) + known
    gradient[:p] = corners.shared_gradient + np.einsum("vpk,vk->p", corners.border, follow) + known_gradient
    prior[s - len(own) :, s - len(own) :] += np.eye(len(own))
    gradient[s - len(own) :] += own
    return Reduced(
        residual=rows.residual + (rows.in_pose @ follow[..., None])[..., 0],
        design=design,
        by_pictures=gain @ np.swapaxes(rows.in_pose, 1, 2),
        prior=prior,
        prior_gradient=gradient,
    )
