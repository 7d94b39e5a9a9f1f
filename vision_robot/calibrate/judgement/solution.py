"""A finished calibration as the solver left it, so that it can be asked further."""

import numpy as np

from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.calibrate.state import State
from vision_robot.types import Array, Float

__all__ = ["solution"]


def solution(result: CalibrationResult, board_points: Float[Array, "m 3"]) -> tuple[State, Problem]:
    """The state at the minimum and the problem it solves, without the corners left out.

    `board_points` (m, 3) [m] are those the calibration was given.
    """
    settings = result.settings
    seen = Observations.of(result.corners, board_points)
    problem = Problem.plain(seen, np.concatenate([result.free, np.ones(len(result.warp), dtype=bool)]))
    problem = problem.trusting(result.trust)
    if settings.priors:
        lengths = np.concatenate([np.linalg.norm(residual, axis=1) for residual in result.residuals])
        weighted = lengths * problem.seen.weight[seen.present]
        variance = float(np.sum(weighted**2)) / max(result.degrees_of_freedom, 1)
        for name, (mean, sigma) in settings.priors.items():
            i = settings.names.index(name)
            problem.prior_mean[i] = mean
            problem.prior_information[i] = variance / sigma**2
    return State(result.camera, result.cam_from_board, result.warp), problem
