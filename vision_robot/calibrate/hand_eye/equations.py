"""The normal equations of the joint refinement: corners, arm and priors, an arrow over the views' poses.

Cost: half the sum of squares of corners' errors over their sigma, of arm residuals over the arm's noise,
and of priors. Each view has a pose of its own, which corners pull to where they see the board and the arm to
where it says it stood; the poses are eliminated by the Schur complement, as in a camera's calibration.
"""

import numpy as np

from vision_robot.calibrate.hand_eye.arm_residuals import ArmRows, arm_rows
from vision_robot.calibrate.hand_eye.problem import HandEyeProblem
from vision_robot.calibrate.hand_eye.state import HandEyeState
from vision_robot.calibrate.normal_equations import NormalEquations, normal_equations

__all__ = ["corner_equations", "hand_eye_equations", "joined"]


def hand_eye_equations(state: HandEyeState, problem: HandEyeProblem) -> NormalEquations:
    """Cost, gradient and Gauss-Newton matrix; an infinite cost where a board lies behind the camera."""
    return joined(state, problem, corner_equations(state, problem), arm_rows(state))


def corner_equations(state: HandEyeState, problem: HandEyeProblem) -> NormalEquations:
    """The part of the corners alone: shared are the free camera parameters."""
    return normal_equations(state.pictures, problem.pictures)


def joined(
    state: HandEyeState, problem: HandEyeProblem, corners: NormalEquations, rows: ArmRows
) -> NormalEquations:
    """Corners, arm and priors together; shared: camera, both ends, the arm's own."""
    p, views = len(corners.shared), len(corners.pose)
    s = p + rows.in_shared.shape[2]
    weights = problem.noise.weights
    r = rows.residual * weights
    J_s, J_p = rows.in_shared * weights[:, None], rows.in_pose * weights[:, None]
    known, known_gradient, known_cost = problem.camera_prior(state.pictures.camera.parameters)
    own = state.arm.values

    shared = np.zeros((s, s))
    shared[:p, :p] = corners.shared + known
    shared[p:, p:] = np.einsum("vik,vil->kl", J_s, J_s)
    shared[s - len(own) :, s - len(own) :] += np.eye(len(own))
    border = np.zeros((views, s, 6))
    border[:, :p] = corners.border
    border[:, p:] = np.swapaxes(J_s, 1, 2) @ J_p
    gradient = np.concatenate([corners.shared_gradient + known_gradient, np.einsum("vik,vi->k", J_s, r)])
    gradient[s - len(own) :] += own
    return NormalEquations(
        cost=corners.cost + known_cost + 0.5 * float(np.vdot(r, r) + own @ own),
        shared=shared,
        border=border,
        pose=corners.pose + np.swapaxes(J_p, 1, 2) @ J_p,
        shared_gradient=gradient,
        pose_gradient=corners.pose_gradient + np.einsum("vik,vi->vk", J_p, r),
    )
