"""Episodes and counterfactual runs made up for tests, without any simulation."""

import numpy as np

from vision_robot.evaluate.attribution import subsets
from vision_robot.geometry import SE3
from vision_robot.pick.budget import Counterfactuals
from vision_robot.pick.episode import Episode, miss_of
from vision_robot.pick.knowledge import STAGES
from vision_robot.pick.moments import Moments
from vision_robot.pick.world import ordinary_world

WORLD = ordinary_world()
GOAL = SE3.from_rotvec(np.array([0, 0, np.pi / 2]), np.array([0.02, -0.17, 0.005]))


def episode(seed=0, x=0.0, y=0.0, yaw=0.0, off=(0.0, 0.0), **changes):
    pose = SE3.from_rotvec(np.array([0, 0, yaw]), np.array([x, y, 0.005]))
    closing = miss_of(pose, pose.translation + np.array([*off, 0]), yaw)
    return Episode(seed, pose, GOAL, thing="rod", closing=closing, seen_error_m=0.001, **changes)


SIGMA = {"calibration": 0.3e-3, "tracking": 0.6e-3, "plane": 0.4e-3, "ik": 0.0, "control": 0.05e-3}


def budget_runs(count=80, *, shift_m=0.0, seed=0):
    """Seeds whose stages err independently, as foretold; the plane by `shift_m` more."""
    rng = np.random.default_rng(seed)
    moments = Moments(STAGES, np.diag([SIGMA[one] ** 2 for one in STAGES]), np.zeros((5, 5)))
    found = []
    for k in range(count):
        parts = {one: rng.normal(size=3) * SIGMA[one] / np.sqrt(2) * [1, 1, 0] for one in STAGES}
        parts["plane"] = parts["plane"] + [shift_m, 0, 0]
        misses = {
            true: sum((parts[one] for one in STAGES if one not in true), np.zeros(3))
            for true in subsets(STAGES)
        }
        found.append(Counterfactuals(k, misses, moments))
    return found
