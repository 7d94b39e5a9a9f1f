"""Paths: the tool along a line, without jumps from one branch to another."""

from dataclasses import dataclass

import numpy as np

from vision_robot.arm.goals import goal_rows
from vision_robot.arm.ik import InverseKinematics
from vision_robot.errors import BadPath
from vision_robot.geometry import SE3, rotation_exp, rotation_log
from vision_robot.types import Array, Float

__all__ = ["JointPath", "follow", "line"]

FINEST_M, FINEST_RAD = 0.002, np.radians(1.0)
"""Steps of a line: joint values between them are then straight to some micrometres."""

JUMP_RAD = 0.3
"""A joint that moves more than this [rad, or times the arm's length scale, m] in one such step has jumped."""


@dataclass(frozen=True)
class JointPath:
    """Joint values along a path, and where they bring the tool."""

    joint_names: tuple[str, ...]
    q: Float[Array, "points n"]
    base_from_tool: SE3
    """The poses asked for."""
    error_m: float
    """Largest distance of the tool from its line at these points."""


def line(start: SE3, end: SE3) -> SE3:
    """Poses from `start` to `end` in even steps: straight in position, about one axis in orientation."""
    turn = rotation_log(start.rotation.T @ end.rotation)
    shift = end.translation - start.translation
    steps = max(np.linalg.norm(shift) / FINEST_M, np.linalg.norm(turn) / FINEST_RAD, 1)
    share = np.linspace(0, 1, int(np.ceil(steps)) + 1)[:, None]
    return SE3(start.rotation @ rotation_exp(share * turn), start.translation + share * shift)


def follow(ik: InverseKinematics, poses: SE3, *, near: Float[Array, "n"] | None = None) -> JointPath:
    """Joint values along close poses, all of one branch.

    Of the branches that hold all the way the one that moves the joints least, or with `near` the one that
    begins nearest to it. Raises BadPath where none does, with how far each comes and what ends it.
    """
    goals, chain = goal_rows(poses, ik.arm.chain, ik.arm.reach_m), ik.arm.chain
    starts = ik.branches(poses[:1]).of_goal(0)
    if not len(starts):
        raise BadPath(0.0, "its first pose cannot be reached")
    most = JUMP_RAD * np.where(chain.slides, ik.program.scale, 1.0)
    q = np.empty((len(starts), len(goals), len(chain)))
    q[:, 0] = starts
    alive, ended = np.ones(len(starts), dtype=bool), np.zeros(len(starts), dtype=int)
    for k in range(1, len(goals)):
        on = np.flatnonzero(alive)
        here = np.repeat(goals[k : k + 1], len(on), axis=0)
        q[on, k] = ik.engine.numeric(here, first=q[on, k - 1], tries=1, iterations=20)
        reached = ik.reached(ik.engine.errors(here, q[on, k]))
        smooth = (np.abs(q[on, k] - q[on, k - 1]) <= most).all(axis=1)
        lost = on[~(reached & smooth)]
        alive[lost], ended[lost] = False, k
        if not alive.any():
            break
    if not alive.any():
        best = int(np.argmax(ended))
        raise BadPath(ended[best] / (len(goals) - 1), _what_ends(ik, q[best, ended[best] - 1]))
    whole = q[alive]
    moved = np.abs(np.diff(whole, axis=1)).sum(axis=1) if near is None else np.abs(whole[:, 0] - near)
    chosen = whole[int(np.argmin((moved / most).sum(axis=1)))]
    error = float(ik.engine.errors(goals, chosen)[:, 0].max())
    return JointPath(chain.joint_names, chosen, poses, error)


def _what_ends(ik: InverseKinematics, last: Float[Array, "n"]) -> str:
    """What stops a branch: the joint at its limit, or a singular arm."""
    chain = ik.arm.chain
    slack = JUMP_RAD * np.where(chain.slides, ik.program.scale, 1.0) / 10
    at = [
        f"{name} is at its limit"
        for i, name in enumerate(chain.joint_names)
        if min(last[i] - chain.limits[i, 0], chain.limits[i, 1] - last[i]) < slack[i]
    ]
    return ", ".join(at) or "the arm is stretched or folded there: it would have to change its branch"
