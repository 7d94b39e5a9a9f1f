"""Suite `ik`: reachable goals of several arms; closed form and iteration beside IPOPT and peers."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from time import process_time

import numpy as np

from vision_robot.arm import Arm, read_arm
from vision_robot.arm.ik import InverseKinematics, Method
from vision_robot.evaluate.peers.kinematics import IK_PEERS, ik_peer
from vision_robot.evaluate.sweep import Cell
from vision_robot.geometry import SE3, SerialChain
from vision_robot.types import Array, Bool, Float
from vision_robot_synth.published_arms import PANDA, PUMA_560, UR5E
from vision_robot_synth.suites.suite import Plan, Suite

__all__ = ["SUITE", "ik_figures", "ik_time"]

GOALS, QUICK_GOALS, QUICK_ARMS = 200, 40, ("column", "ur5e")
CLOSE_M, CLOSE_RAD = 1e-5, np.radians(0.01)
"""How near a goal counts as reached, by numpy's own kinematics."""

OFF_M, OFF_RAD = 1e-3, np.radians(0.3)
"""How far the links of a real arm are from the drawing."""

TIMED_SEEDS, TIMED_S, FEW = 3, 0.3, 20

Answer = tuple[Float[Array, "goals n"], Bool[Array, "goals"]]
"""Joint values, and which goals the solver says it reached."""


def _off() -> Arm:
    """The column arm as it might really be, measured; its drawing is known too."""
    arm, rng = read_arm("column"), np.random.default_rng(3)
    links = arm.chain.link_from_joint
    n = len(links)
    off = SE3.from_rotvec(rng.normal(0, OFF_RAD, (n, 3)), rng.normal(0, OFF_M, (n, 3)))
    return arm.calibrated(replace(arm.chain, link_from_joint=links @ off))


ARMS: dict[str, Callable[[], Arm]] = {
    "column": lambda: read_arm("column"),
    "column-off": _off,
    "ur5e": lambda: Arm("UR5e", UR5E, "base", "tool"),
    "puma-560": lambda: Arm("Puma 560", PUMA_560, "base", "tool"),
    "panda": lambda: Arm("Panda", PANDA, "base", "tool"),
}

OURS: dict[str, tuple[Method, bool | None]] = {
    "vr": (Method.AUTO, None),
    "vr-closed-form": (Method.CLOSED_FORM, False),
    "vr-closed-form-c": (Method.CLOSED_FORM, True),
    "vr-numeric": (Method.NUMERIC, False),
    "vr-numeric-c": (Method.NUMERIC, True),
    "vr-as-drawn": (Method.AUTO, None),
}
"""Name -> (how, compiled or not); `vr` is what the tool takes by itself, `vr-as-drawn` does not know
what was measured on the arm."""


def cells(plan: Plan) -> Sequence[Cell]:
    """Every arm by every method by every seed, and times of each."""
    scenes, methods = SUITE.chosen(plan)
    if plan.quick:
        scenes = plan.scenes or QUICK_ARMS
    goals = QUICK_GOALS if plan.quick else GOALS

    def cell(scene: str, method: str, seed: int, work: str, *, alone: bool = False) -> Cell:
        parameters = {"arm": scene, "method": method, "seed": seed, "goals": goals}
        return Cell("ik", scene, method, seed, f"{__name__}:{work}", parameters, alone)

    grid = [(scene, method) for scene in scenes for method in methods]
    return [
        *(cell(*one, seed, "ik_figures") for seed in plan.seed_range for one in grid),
        *(cell(*one, seed, "ik_time", alone=True) for seed in plan.seed_range[:TIMED_SEEDS] for one in grid),
    ]


def ik_figures(workspace: Path, arm: str, method: str, seed: int, goals: int) -> dict[str, float]:  # noqa: ARG001
    """Success, wrong answers and distance of one method on goals that lie inside the limits."""
    real = _arm(arm).chain
    wanted = _goals(real, seed, goals)
    q, told = _solver(arm, method)(wanted)
    given = np.isfinite(q).all(axis=1)
    told, q = told & given, np.nan_to_num(q)
    off = wanted.inverse() @ real.base_from_tool(q)
    distance = np.linalg.norm(off.translation, axis=1)
    near = (distance < CLOSE_M) & (np.linalg.norm(off.rotvec(), axis=1) < CLOSE_RAD)
    right = near & given & real.within_limits(q, 1e-9)
    return {
        "ik_success": float(right.mean()),
        "ik_wrong": float((told & ~right).mean()),
        "ik_position_error_mm": 1e3 * float(np.median(distance[given])) if given.any() else np.nan,
    }


def ik_time(workspace: Path, arm: str, method: str, seed: int, goals: int) -> dict[str, float]:  # noqa: ARG001
    """Goals a second of processor time, the call from Python included, all goals in one call."""
    solve, wanted = _solver(arm, method), _goals(_arm(arm).chain, seed, goals)
    solve(wanted[:1])  # what is done once is not timed
    start = process_time()
    solve(wanted[:FEW])
    if process_time() - start > TIMED_S:
        return {"ik_solves_per_s": FEW / (process_time() - start)}
    done, start = 0, process_time()
    while process_time() - start < TIMED_S:
        solve(wanted)
        done += len(wanted)
    return {"ik_solves_per_s": done / (process_time() - start)}


@cache
def _arm(name: str) -> Arm:
    return ARMS[name]()


def _goals(chain: SerialChain, seed: int, count: int) -> SE3:
    q = np.random.default_rng([seed, 17]).uniform(*chain.limits.T, size=(count, len(chain)))
    return chain.base_from_tool(q)


@cache
def _solver(name: str, method: str) -> Callable[[SE3], Answer]:
    """Built once in a process: an arm's functions take a second."""
    arm = _arm(name)
    if method in OURS:
        how, compiled = OURS[method]
        if method == "vr-as-drawn":
            arm = replace(arm, chain=arm.nominal or arm.chain, nominal=None)
        ours = InverseKinematics(arm, method=how, compiled=compiled)

        def by_us(goals: SE3) -> Answer:
            found = ours.solve(goals)
            return found.q, found.converged

        return by_us
    peer = ik_peer(method, arm.chain)

    def by_peer(goals: SE3) -> Answer:
        q = peer(goals)
        return q, np.asarray(np.isfinite(q).all(axis=1))

    return by_peer


SUITE = Suite("ik", tuple(ARMS), (*OURS, *IK_PEERS), "ik_success", 0.5, cells)
