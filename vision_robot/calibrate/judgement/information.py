"""What each view tells of the shared parameters, once its own pose is free to follow."""

import numpy as np

from vision_robot.calibrate.normal_equations import normal_equations
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.state import State
from vision_robot.types import Array, Bool, Float

__all__ = ["view_information"]


def view_information(
    state: State, seen: Observations, free: Bool[Array, "s"]
) -> tuple[Float[Array, "views f f"], Float[Array, "views f"]]:
    """Of each view alone: information ``B - W V^-1 W^T`` and gradient ``g - W V^-1 h``, its pose following.

    In units of the corners' weights, over the free shared parameters.
    """
    f = int(free.sum())
    information, gradient = np.zeros((seen.views, f, f)), np.zeros((seen.views, f))
    problem = Problem.plain(seen, free)
    for i in range(seen.views):
        one = slice(i, i + 1)
        alone = State(state.camera, state.cam_from_board[one], state.warp)
        e = normal_equations(alone, problem.of(seen[one]))
        gain = np.linalg.solve(e.pose[0], e.border[0].T).T
        information[i] = e.shared - gain @ e.border[0].T
        gradient[i] = e.shared_gradient - gain @ e.pose_gradient[0]
    return information, gradient
