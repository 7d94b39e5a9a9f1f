"""What the views can tell, asked before any number is given."""

from dataclasses import replace

import numpy as np

from vision_robot.calibrate.covariance import NULL, Covariance, covariance
from vision_robot.calibrate.normal_equations import cost
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.refine import Refinement, refine, schur_complement
from vision_robot.calibrate.state import State
from vision_robot.errors import DegenerateViews, NoConvergence
from vision_robot.geometry import SE3
from vision_robot.geometry.camera import AFFINE_NAMES
from vision_robot.types import Array

__all__ = ["identified", "tilt_spread"]

PARABOLIC = 0.4
"""Largest |log| of found over foretold rise of the cost; brown5 and fisheye stay below 0.1."""

FIRM = 1e-7
"""Eigenvalue of the scaled Schur complement from which a valley is a parabola: brown5 and fisheye have 1e-5,
brown8 where its fractions cancel below 1e-9."""

VAGUE = 0.1
"""A standard deviation of more than this part of the parameter's scale is no knowledge."""


def identified(end: Refinement, problem: Problem) -> Covariance:
    """The covariance at the minimum.

    Raises DegenerateViews naming the affine parameters that the views leave free; lens
    coefficients and warps that cannot be told apart are listed in `Covariance.undetermined`.
    """
    variance = 2 * end.equations.cost / max(problem.degrees_of_freedom, 1)
    state = end.state
    known = covariance(end.equations, problem.free, state, variance)
    if set(known.undetermined) & set(AFFINE_NAMES):
        raise DegenerateViews(known.undetermined, "the equations leave them free")
    camera = state.camera
    sigma = dict(zip(camera.parameter_names, known.sigma, strict=True))
    scales = {"fx": camera.fx, "fy": camera.fy, "cx": camera.width, "cy": camera.height, "skew": camera.fx}
    vague = [name for name, scale in scales.items() if sigma[name] > VAGUE * scale]
    if vague:
        raise DegenerateViews(vague, "one standard deviation would exceed a tenth of their size")
    nearly_parallel = tilt_spread(state.cam_from_board) < np.radians(15)
    if nearly_parallel and _focal_is_loose(end, problem, variance):
        raise DegenerateViews(("fx", "fy"), "the views are nearly parallel to each other")
    bent = _bent(end, problem, known, variance)
    return replace(known, undetermined=tuple(dict.fromkeys((*known.undetermined, *bent))))


def _bent(end: Refinement, problem: Problem, known: Covariance, variance: float) -> tuple[str, ...]:
    """Lens coefficients whose sigma means nothing, since the valley they lie in is not a parabola.

    The numerator and denominator of a rational lens can cancel along a curved valley: a
    linear sigma then holds the truth in 70 of 100 cases instead of 95. Two standard
    deviations are stepped either way along the direction that is known least, poses
    following; the cost must rise as the parabola foretells.
    """
    equations = end.equations
    S = schur_complement(equations)
    scale = 1 / np.sqrt(np.maximum(np.diag(equations.shared), 1e-300))
    values, vectors = np.linalg.eigh(S * scale[:, None] * scale)
    if values[0] < NULL or values[0] > FIRM:
        return ()
    sigma = scale * vectors[:, 0] * np.sqrt(variance / values[0])
    gain = np.linalg.solve(equations.pose, equations.border.transpose(0, 2, 1))
    for step in (2 * sigma, -2 * sigma):
        moved = end.state.moved(problem.free, step, -gain @ step)
        rise = cost(moved, problem) - equations.cost if moved else np.inf
        if not abs(np.log(max(rise, 1e-300) / (2 * variance))) <= PARABOLIC:
            break
    else:
        return ()
    index = np.flatnonzero(problem.free)
    own = np.sqrt(np.diag(known.shared))[index]
    names = end.state.shared_names
    tied = index[np.abs(sigma) > 0.5 * own]
    return tuple(names[int(i)] for i in tied if 5 <= i < known.intrinsic_count)


def tilt_spread(cam_from_board: SE3) -> float:
    """Largest angle between a board's normal and their mean [rad]."""
    normals = cam_from_board.rotation[:, :, 2]
    mean = normals.mean(axis=0)
    return float(np.arccos(np.clip((normals @ mean / np.linalg.norm(mean)).min(), -1, 1)))


def _focal_is_loose(end: Refinement, problem: Problem, variance: float) -> bool:
    """Whether another focal length explains the corners as well: the profile likelihood, asked directly.

    Noise bends parallel boards by apparent tilts whose curvature makes the covariance look
    firm where it is not, so the covariance cannot be trusted to tell.
    """
    focal_held: Array = problem.free.copy()
    focal_held[:2] = False
    if problem.prior_information[:2].any() or not problem.free[:2].all():
        return False
    pose = end.state.cam_from_board
    for factor in (1.15, 1 / 1.15):
        parameters = end.state.camera.parameters
        parameters[:2] *= factor
        farther = SE3(pose.rotation, pose.translation * [1, 1, factor])
        other = State(end.state.camera.with_parameters(parameters), farther, end.state.warp)
        try:
            refit = refine(other, problem.freeing(focal_held), max_iterations=30, tolerance=0.1)
        except NoConvergence:
            continue
        if 2 * (refit.equations.cost - end.equations.cost) < 25 * variance:
            return True
    return False
