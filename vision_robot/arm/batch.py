"""Many goals on all cores: threads over compiled code, which runs beside Python; processes over numpy."""

import os
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import numpy as np

from vision_robot.arm.ik import InverseKinematics
from vision_robot.arm.model import Arm
from vision_robot.arm.solutions import Solutions
from vision_robot.geometry import SE3
from vision_robot.types import Array, Float

__all__ = ["solve_on_all_cores", "usable_cores"]

WORTH_THREADS, WORTH_PROCESSES = 4_000, 100_000
"""Goals below which one core is as fast: processes take about a second to start."""


def usable_cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def solve_on_all_cores(
    ik: InverseKinematics,
    base_from_tool: SE3,
    *,
    near: Float[Array, "... n"] | None = None,
    workers: int | None = None,
) -> Solutions:
    """What `ik.solve` answers, the goals shared out over the cores (or `workers` of them)."""
    count = len(base_from_tool)
    compiled = ik.engine.name != "numpy"
    workers = min(workers or usable_cores(), max(count, 1))
    if workers < 2 or count < (WORTH_THREADS if compiled else WORTH_PROCESSES):
        return ik.solve(base_from_tool, near=near)
    each = near is not None and np.ndim(near) == 2 and len(near) == count
    # More parts than workers, so that none waits long for the one with the hardest goals.
    edges = np.linspace(0, count, 4 * workers + 1).astype(int)
    parts = [slice(int(a), int(b)) for a, b in pairwise(edges) if a < b]
    tasks = [(base_from_tool[part], near[part] if each and near is not None else near) for part in parts]
    if compiled:
        with ThreadPoolExecutor(workers) as pool:
            return Solutions.joined(list(pool.map(lambda task: ik.solve(task[0], near=task[1]), tasks)))
    from joblib import Parallel, delayed

    settings = {"task": ik.task, "method": ik.method, "compiled": False, "tolerance": ik.tolerance}
    run = delayed(_in_a_process)
    answers = Parallel(n_jobs=workers)(run(ik.arm, settings, goals, start) for goals, start in tasks)
    return Solutions.joined([answer for answer in answers if answer is not None])


def _in_a_process(arm: Arm, settings: dict, goals: SE3, near: Array | None) -> Solutions:
    return InverseKinematics(arm, **settings).solve(goals, near=near)
