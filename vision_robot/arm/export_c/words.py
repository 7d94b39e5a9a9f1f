"""What the generated files say: numbers and sentences for their templates."""

from collections.abc import Mapping
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

import vision_robot
from vision_robot.arm import symbolic
from vision_robot.arm.export_c.fingerprint import fingerprint
from vision_robot.arm.export_c.precision import Precision
from vision_robot.arm.export_c.starts import LAST_PATIENCE, PATIENCE, Starts, golden_steps
from vision_robot.arm.export_c.straight_line import StraightLine
from vision_robot.arm.model import Arm
from vision_robot.arm.task import Task
from vision_robot.geometry import SerialChain

if TYPE_CHECKING:
    from vision_robot.arm.closed_form import ClosedForm

__all__ = ["SPREAD", "cases", "rendered", "source", "words_of"]

SPREAD = 150
"""Starts beyond the table before a goal counts as out of reach."""
POLISH = 6
"""Steps at most on a branch of the closed form that just misses the goal."""
CASES = 32
"""Of the self-test."""

TASKS = {
    Task.POSE: "all six numbers, position and orientation",
    Task.AXIS: "position and the direction of the tool's z axis; the tool may turn about it",
    Task.TILT: "position and the tool's stand to the base's z axis; it may turn about that axis",
    Task.POSITION: "position alone",
}


def source(name: str) -> str:
    """A file of C as it stands in the package."""
    return (files("vision_robot.arm.export_c") / "sources" / name).read_text(encoding="utf-8")


def rendered(name: str, fill: Mapping[str, Any]) -> str:
    """A generated file: its template, filled in."""
    from jinja2 import Environment, StrictUndefined

    engine = Environment(
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    return engine.from_string(source(f"{name}.j2")).render(fill)


def words_of(
    arm: Arm,
    chain: SerialChain,
    real: Precision,
    task: Task,
    kernels: Mapping[str, StraightLine],
    *,
    starts: Starts | None,
    closed: "ClosedForm | None",
) -> dict[str, Any]:
    """What the templates ask for about the arm; `chain` has its limits in the target's precision."""
    method = "damped steps from several starts" if closed is None else f"closed form, {closed.structure}"
    numbers = [real.literal(value) for value in chain.limits.ravel()]
    used = {name for kernel in kernels.values() for name in kernel.functions} | {"sqrt", "sin", "cos"}
    return {
        "arm": arm,
        "version": vision_robot.__version__,
        "precision": real,
        "task": task.value,
        "task_words": TASKS[task],
        "numeric": closed is None,
        "structure": "" if closed is None else closed.structure,
        "polish": POLISH,
        "near": 1e-3,
        "branches": 0 if closed is None else closed.branches,
        "method_words": method,
        "choice_words": "from the nearest start that leads there, `now` first"
        if closed is None
        else "the branch nearest to `now`",
        "math_functions": sorted(real.function(name) for name in used),
        "joints": [_joint(chain, i) for i in range(len(chain))],
        "name_width": max(4, *(len(name) for name in chain.joint_names)),
        "fingerprint": fingerprint(arm.chain),
        "tolerance_m": real.reached_m,
        "tolerance_rad": real.reached_rad,
        "length": symbolic.length_scale(chain),
        "lower": numbers[0::2],
        "upper": numbers[1::2],
        "slides": [int(slides) for slides in chain.slides],
        "same": 1e-3 if real.suffix else 1e-5,
        "slack": 1e-6 if real.suffix else 1e-9,
        "patience": PATIENCE,
        "last_patience": LAST_PATIENCE,
        "spread": SPREAD,
        "starts": [] if starts is None else [[real.literal(x) for x in q] for q in starts.q],
        "goals": 0 if starts is None else starts.goals,
        "golden": [f"{step}u" for step in golden_steps(len(chain))],
        "kernels": [kernel.code for kernel in kernels.values()],
    }


def _joint(chain: SerialChain, i: int) -> dict[str, str]:
    low, high = chain.limits[i]
    if chain.slides[i]:
        return {"name": chain.joint_names[i], "moves": "slides", "range": f"{low:.6g} ... {high:.6g} m"}
    degrees = f"({np.degrees(low):.6g} ... {np.degrees(high):.6g} deg)"
    return {
        "name": chain.joint_names[i],
        "moves": "turns ",
        "range": f"{low:.6g} ... {high:.6g} rad {degrees}",
    }


def cases(chain: SerialChain, real: Precision, seed: int) -> list[list[str]]:
    """Joints and the pose they give, by numpy's kinematics and not by the expressions that are exported."""
    rng = np.random.default_rng(seed)
    half = 0.499 * np.diff(chain.limits)[:, 0]  # a hair inside, whatever the rounding
    inside = chain.limits.mean(axis=1) + half * rng.uniform(-1, 1, (CASES, len(chain)))
    pose = chain.base_from_tool(inside).as_matrix()[:, :3].reshape(CASES, 12)
    return [[real.literal(x) for x in row] for row in np.hstack([inside, pose])]
