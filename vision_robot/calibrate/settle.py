"""From nothing to the minimum: a start, then the descent, in stages where the lens is hard."""

import numpy as np

from vision_robot.calibrate.identifiability import tilt_spread
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.refine import Refinement, refine
from vision_robot.calibrate.settings import Settings
from vision_robot.calibrate.start import poses_from_bearings, start
from vision_robot.calibrate.state import State
from vision_robot.calibrate.warp import Warp
from vision_robot.errors import DegenerateViews, NoConvergence

__all__ = ["settle"]

VIEWS_FOR_START = 40


def settle(problem: Problem, size: tuple[int, int], settings: Settings, warp: Warp) -> Refinement:
    """The least-squares minimum over camera, warp and poses.

    A large set is settled on some of its views first, so that all steps but the last few
    are cheap. Raises DegenerateViews when nothing can be started from, NoConvergence when
    the descent does not settle.
    """
    seen = problem.seen
    few = seen
    if seen.views > 2 * VIEWS_FOR_START:
        few = seen[np.linspace(0, seen.views - 1, VIEWS_FOR_START).astype(int)]
    state = start(few, size, settings, warp)
    try:
        end = _in_stages(state, problem.of(few))
    except NoConvergence:
        if tilt_spread(state.cam_from_board) < np.radians(10):
            affine = ("fx", "fy", "cx", "cy")
            raise DegenerateViews(affine, "the views are nearly parallel to each other") from None
        raise
    if few is seen:
        return end
    camera = end.state.camera
    return refine(State(camera, poses_from_bearings(camera, seen), end.state.warp), problem)


def _in_stages(state: State, problem: Problem) -> Refinement:
    """Refine all at once; where that fails, first K alone, then the lens, then the board."""
    try:
        return refine(state, problem)
    except NoConvergence:
        index = np.arange(len(problem.free))
        for stop in (5, 7, len(state.camera.parameters)):
            stage = problem.freeing(problem.free & (index < stop))
            state = refine(state, stage, tolerance=0.1).state
        return refine(state, problem, max_iterations=300)
