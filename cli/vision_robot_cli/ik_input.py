"""What `vr ik solve` is asked, and the solving."""

import re
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from vision_robot.arm import Arm, Task
from vision_robot.arm.batch import solve_on_all_cores
from vision_robot.arm.ik import InverseKinematics, Method
from vision_robot.arm.solutions import Branches, Solutions
from vision_robot.arm.unreachable import Reason, Unreachable
from vision_robot.arm.workspace import tool_down
from vision_robot.calibrate.hand_eye.rotations import from_quaternion
from vision_robot.errors import BadGoal, BadInput, BadParameter
from vision_robot.geometry import SE3
from vision_robot_cli.arm_options import NUMBER, UNITS
from vision_robot_cli.goal_file import Goals, read_goals
from vision_robot_cli.output import note

__all__ = ["Answer", "Choices", "choices", "goals", "solved"]

MOST_REASONS = 50
"""Goals out of reach that are explained one by one; each takes up to a second."""


class Choices(NamedTuple):
    """Task, method and preference."""

    task: Task
    method: Method
    prefer: str


@dataclass(frozen=True)
class Answer:
    """Solutions with everything that is told about them."""

    arm: Arm
    ik: InverseKinematics
    goals: Goals
    solutions: Solutions
    seconds: float
    reasons: dict[int, Reason] = field(default_factory=dict)
    hints: dict[int, str] = field(default_factory=dict)
    branches: Branches | None = None

    @property
    def unreached(self) -> int:
        """Goals that are not reached."""
        return int((~self.solutions.converged).sum())


def choices(task: str, method: str, prefer: str) -> Choices:
    """The options that are words; raises BadParameter."""
    for name, value, known in (
        ("--task", task, [one.value for one in Task]),
        ("--method", method, [one.value for one in Method]),
        ("--prefer", prefer, ["near", "margin", "free"]),
    ):
        if value not in known:
            raise BadParameter(name, value, "one of " + ", ".join(known))
    return Choices(Task(task), Method(method), prefer)


def goals(
    path: Path | None, position: str | None, yaw: str, quaternion: str | None, station: Path | None
) -> Goals:
    """Goal poses of the tool in the base."""
    if (path is None) == (position is None):
        raise BadParameter("goals", [str(path), position], "a file, or --position X,Y,Zmm, and not both")
    if path is not None:
        asked = read_goals(path)
    else:
        turn = tool_down(np.array(_angle(yaw))) if quaternion is None else _quaternion(quaternion)
        asked = Goals(SE3(turn[None], _place(position or "")[None]), ("--position",))
    if station is None:
        return asked
    where = read_goals(station).poses
    if len(where) != 1:
        raise BadParameter("--station", str(station), f"a file of one pose; it holds {len(where)}")
    moved = where[0] @ asked.poses
    other = where[0] @ asked.other_poses if asked.other_poses is not None else None
    return Goals(moved, asked.where, asked.order, asked.other_order, other)


def solved(
    arm: Arm, asked: Goals, chosen: Choices, near: np.ndarray | None, source: str, *, every: bool
) -> Answer:
    """Solve, choose, and find out why what is not reached is not."""
    ik = InverseKinematics(arm, chosen.task, method=chosen.method)
    start = None if chosen.prefer == "margin" else near
    began = time.process_time()
    try:
        found = solve_on_all_cores(ik, asked.poses, near=start)
    except BadGoal as bad:
        raise BadGoal(bad.row, bad.why, asked.where[bad.row]) from bad
    seconds = time.process_time() - began
    branches = ik.branches(asked.poses) if every or chosen.prefer == "free" else None
    if chosen.prefer == "free" and branches is not None:
        found = _free(arm, found, branches, near, source)
    left = np.flatnonzero(~found.converged)
    unreachable = Unreachable(ik)
    reasons = {int(k): unreachable.reason(asked.poses, found, int(k)) for k in left[:MOST_REASONS]}
    return Answer(
        arm, ik, asked, found, seconds, reasons, _order_hints(ik, asked, left), branches if every else None
    )


def _free(arm: Arm, found: Solutions, branches: Branches, near: np.ndarray | None, source: str) -> Solutions:
    """Of each goal's branches the nearest that touches nothing; a goal without one is not reached."""
    from dataclasses import replace
    from importlib.resources import files

    from vision_robot.arm import ARMS
    from vision_robot.arm.collision import free_of_collision

    path = files("vision_robot.arm") / "models" / ARMS[source] if source in ARMS else Path(source)
    q, converged = found.q.copy(), found.converged.copy()
    for k in range(len(q)):
        own = branches.of_goal(k)
        own = own[free_of_collision(str(path), arm.chain.joint_names, own)] if len(own) else own
        converged[k] = bool(len(own))
        if len(own):
            off = own - (near if near is not None else arm.chain.limits.mean(axis=1))
            q[k] = own[int(np.argmin((off**2).sum(axis=1)))]
    return replace(found, q=q, converged=converged)


def _order_hints(ik: InverseKinematics, asked: Goals, left: np.ndarray) -> dict[int, str]:
    """Goals out of reach that the other order of quaternions would bring within it."""
    if asked.other_poses is None or not len(left):
        return {}
    try:
        _, reached = ik.sketch(asked.other_poses[left])
    except BadInput:
        return {}
    if reached.any():
        note(
            f"vr: {int(reached.sum())} of {len(left)} goals out of reach would be reached with quaternions "
            f"read as {asked.other_order} instead of {asked.order}: check the names of the columns"
        )
    hint = f"quaternion order? read as {asked.other_order} it is reached"
    return {int(k): hint for k in left[reached]}


def _place(text: str) -> np.ndarray:
    match = re.fullmatch(rf"\s*({NUMBER})\s*,\s*({NUMBER})\s*,\s*({NUMBER})\s*(mm|cm|m)\s*", text)
    if not match:
        raise BadParameter("--position", text, "X,Y,Z with the unit at the end, such as 300,0,100mm")
    return np.array([float(match[k]) for k in (1, 2, 3)]) * UNITS[match[4]]


def _angle(text: str) -> float:
    match = re.fullmatch(rf"\s*({NUMBER})\s*(deg|rad)\s*", text)
    if not match:
        raise BadParameter("--yaw", text, "an angle with its unit, such as 30deg")
    return float(match[1]) * UNITS[match[2]]


def _quaternion(text: str) -> np.ndarray:
    allowed = "wxyz=W,X,Y,Z or xyzw=X,Y,Z,W, of length 1"
    match = re.fullmatch(rf"\s*(wxyz|xyzw)\s*=\s*({NUMBER}(?:\s*,\s*{NUMBER}){{3}})\s*", text)
    if not match:
        raise BadParameter("--quaternion", text, allowed)
    turn, off = from_quaternion(np.array([[float(part) for part in match[2].split(",")]]), match[1])
    if off[0] > 1e-3:
        raise BadParameter("--quaternion", text, f"{allowed}; its length is off by {off[0]:.3g}")
    return turn[0]
