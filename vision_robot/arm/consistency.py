"""Whether forward and inverse kinematics of an arm say the same."""

import time
from dataclasses import dataclass

import numpy as np

from vision_robot.arm.ik import InverseKinematics, Method
from vision_robot.arm.model import Arm
from vision_robot.arm.starts import windows
from vision_robot.arm.task import Task
from vision_robot.geometry import SE3

__all__ = ["Consistency", "check_consistency"]

REACHED_M, REACHED_RAD = 1e-5, np.radians(0.01)
"""0.01 mm and 0.01 degrees."""


@dataclass(frozen=True)
class Consistency:
    """One method over targets drawn inside the limits, measured by the chain's own kinematics."""

    method: str
    engine: str
    targets: int
    reached: int
    """Within 0.01 mm and 0.01 degrees and inside the limits."""
    wrong: int
    """Called reached by the solver, and not."""
    position_error_m: float
    orientation_error_rad: float
    """The largest among those reached."""
    solves_per_s: float
    """Of one core's time."""


def check_consistency(arm: Arm, *, targets: int = 4000, seed: int = 0) -> list[Consistency]:
    """Draw joint values, bring the tool there, ask for joint values: each method there is, one row each."""
    rng = np.random.default_rng(seed)
    goals = arm.chain.base_from_tool(rng.uniform(*windows(arm.chain).T, size=(targets, len(arm))))
    rows = []
    for method in (Method.CLOSED_FORM, Method.NUMERIC):
        ik = InverseKinematics(arm, Task.POSE, method=Method.AUTO if method is Method.CLOSED_FORM else method)
        if method is Method.CLOSED_FORM and not ik.uses_closed_form:
            continue
        rows.append(_measured(ik, method.value, goals))
    return rows


def _measured(ik: InverseKinematics, method: str, goals: SE3) -> Consistency:
    ik.solve(goals[:64])
    began = time.process_time()
    found = ik.solve(goals)
    seconds = time.process_time() - began
    there = ik.arm.chain.base_from_tool(found.q)
    distance = np.linalg.norm(there.translation - goals.translation, axis=1)
    turn = np.swapaxes(there.rotation, 1, 2) @ goals.rotation
    angle = np.linalg.norm(SE3(turn, np.zeros_like(there.translation)).rotvec(), axis=1)
    reached = (distance < REACHED_M) & (angle < REACHED_RAD) & ik.arm.chain.within_limits(found.q)
    return Consistency(
        method=method,
        engine=ik.engine.name,
        targets=len(goals),
        reached=int(reached.sum()),
        wrong=int((found.converged & ~reached).sum()),
        position_error_m=float(distance[reached].max(initial=0)),
        orientation_error_rad=float(angle[reached].max(initial=0)),
        solves_per_s=len(goals) / max(seconds, 1e-9),
    )
