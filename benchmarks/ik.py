"""Inverse kinematics: how many goals are reached, how many answers are wrong, how fast; ours and peers.

    python benchmarks/ik.py [--goals 40000] [--peers-python PYTHON] [--quick] [--json]

Goals are poses of joint values drawn inside the limits, so all of them can be reached. Success: within
0.01 mm and 0.01 degrees of the goal by numpy's own kinematics, and inside all limits. Wrong: said to be
reached, and is not. Times are processor time of one core, the call from Python included. Peers run in an
interpreter of their own on some of the same goals (`ik_peers.py`).
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from time import process_time

# Threads that wait inside numpy's algebra would count as work.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from table import markdown, shown

from vision_robot.arm import Arm, read_arm
from vision_robot.arm.ik import InverseKinematics, Method
from vision_robot.errors import BadParameter, UnknownStructure
from vision_robot.geometry import SE3, SerialChain
from vision_robot.types import Array, Float

sys.path.append(str(Path(__file__).parents[1]))
from tests.arm.arms import PANDA, PUMA_560, UR5E

CLOSE_M, CLOSE_RAD = 1e-5, np.radians(0.01)
PEER_GOALS = 2000
BEST_OF = 3


def arms() -> dict[str, Arm]:
    """Our arm, real arms by their published dimensions, and ours as it might really be."""
    column = read_arm("column")
    rng = np.random.default_rng(3)
    links = column.chain.link_from_joint
    off = SE3.from_rotvec(
        rng.normal(0, np.radians(0.3), (len(links), 3)), rng.normal(0, 1e-3, (len(links), 3))
    )
    real = replace(column.chain, link_from_joint=links @ off)
    return {
        "column": column,
        "column, 1 mm and 0.3 deg off": column.calibrated(real),
        "UR5e": Arm("UR5e", UR5E, "base", "tool"),
        "Puma 560": Arm("Puma 560", PUMA_560, "base", "tool"),
        "Panda (7 joints)": Arm("Panda", PANDA, "base", "tool"),
    }


def goals_of(chain: SerialChain, count: int) -> SE3:
    """Poses that joint values inside the limits give."""
    q = np.random.default_rng(1).uniform(*chain.limits.T, size=(count, len(chain)))
    return chain.base_from_tool(q)


def judged(chain: SerialChain, goals: SE3, q: Float[Array, "goals n"]) -> Float[Array, "goals"]:
    """Which joint values bring the tool to the goals, inside the limits."""
    off = goals.inverse() @ chain.base_from_tool(q)
    near = np.linalg.norm(off.translation, axis=1) < CLOSE_M
    return near & (np.linalg.norm(off.rotvec(), axis=1) < CLOSE_RAD) & chain.within_limits(q, 1e-9)


def row(arm: Arm, goals: SE3, method: Method, *, compiled: bool, repeats: int) -> dict[str, float] | None:
    """Figures of one way to solve; None where this arm or machine has it not."""
    try:
        solver = InverseKinematics(arm, method=method, compiled=compiled)
    except (UnknownStructure, BadParameter):
        return None
    found, seconds = solver.solve(goals[:50]), []
    for _ in range(repeats):
        start = process_time()
        found = solver.solve(goals)
        seconds.append(process_time() - start)
    right = judged(arm.chain, goals, found.q)
    return {
        "success": float(right.mean()),
        "wrong": int((found.converged & ~right).sum()),
        "solves_per_s": len(goals) / min(seconds),
    }


def peers(python: str, goals: SE3, chain: SerialChain) -> dict[str, dict[str, float]]:
    """What other solvers make of some of the goals for the column arm."""
    with tempfile.TemporaryDirectory() as folder:
        given = Path(folder) / "goals.npz"
        np.savez(
            given,
            goals=goals[:PEER_GOALS].as_matrix(),
            limits=chain.limits,
            links=chain.link_from_joint.as_matrix(),
            axes=chain.axes,
            slides=chain.slides,
            tool=(chain.last_from_wrist @ chain.wrist_from_tool).as_matrix(),
        )
        script = Path(__file__).with_name("ik_peers.py")
        subprocess.run([python, str(script), str(given), folder], capture_output=True, check=True)
        figures: dict[str, dict[str, float]] = {}
        for name, said in json.loads((Path(folder) / "seconds.json").read_text()).items():
            q = np.load(Path(folder) / f"{name}.npy")
            right = judged(chain, goals[: PEER_GOALS : said["every"]], np.nan_to_num(q))
            figures[name] = {
                "success": float(right.mean()),
                "wrong": int((~np.isnan(q[:, 0]) & ~right).sum()),
                "solves_per_s": len(q) / said["seconds"],
            }
    return figures


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--goals", type=int, default=40_000)
    parser.add_argument("--peers-python", help="interpreter that has roboticstoolbox, pytracik, ikpy or pin")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    count = 200 if options.quick else options.goals
    figures: dict[str, dict[str, float]] = {}
    for name, arm in list(arms().items())[: 2 if options.quick else None]:
        goals = goals_of(arm.chain, count)
        for method in (Method.CLOSED_FORM, Method.NUMERIC):
            for compiled in (False, True):
                if method is Method.CLOSED_FORM and arm.nominal is not None:
                    continue  # of the drawn arm, and so not the real one's
                found = row(arm, goals, method, compiled=compiled, repeats=1 if options.quick else BEST_OF)
                if found:
                    figures[f"{name}: {method.value}{', compiled' if compiled else ''}"] = found
        if arm.nominal is not None:
            found = row(arm, goals, Method.AUTO, compiled=False, repeats=1)
            if found:
                figures[f"{name}: closed form as seed"] = found
    if options.peers_python:
        column = arms()["column"].chain
        figures |= peers(options.peers_python, goals_of(column, count), column)
    rows = [
        [name, f"{100 * f['success']:.3f}", f["wrong"], f"{f['solves_per_s']:,.0f}"]
        for name, f in figures.items()
    ]
    table = markdown(["arm: method", "success, %", "wrong", "solves/s of one core"], rows)
    print(shown("vr.benchmark.ik/1", figures, f"{table}\n\n{count} goals.", as_json=options.json))


if __name__ == "__main__":
    main()
