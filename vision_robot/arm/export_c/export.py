"""An arm's kinematics as a folder of C for a microcontroller."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vision_robot.arm import symbolic
from vision_robot.arm.export_c.cost import Cost, cycles, estimated, measured
from vision_robot.arm.export_c.fingerprint import fingerprint
from vision_robot.arm.export_c.precision import Precision, precision_named
from vision_robot.arm.export_c.starts import Starts, covering_starts
from vision_robot.arm.export_c.straight_line import StraightLine, straight_line
from vision_robot.arm.export_c.words import cases, rendered, source, words_of
from vision_robot.arm.model import Arm
from vision_robot.arm.task import Task
from vision_robot.errors import BadParameter, UnknownStructure
from vision_robot.files import write_text
from vision_robot.geometry import SerialChain

if TYPE_CHECKING:
    from casadi import Function

    from vision_robot.arm.closed_form import ClosedForm

__all__ = ["METHODS", "TARGETS", "Export", "export_c"]

METHODS = ("auto", "closed-form", "numeric")
TARGETS = {"cortex-m4f": "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16"}
"""What the Makefile compiles for, and the compiler's words for it."""
PLAIN = ("vr_ik.c", "vr_link.h", "vr_link.c", "example.c", "filter.c", "receiver.c", "qemu_user.c")
WRITTEN = ("vr_arm.h", "vr_kernels.h", "selftest.c", "Makefile", "README.md")


@dataclass(frozen=True)
class Export:
    """What was written, and what it costs."""

    folder: Path
    files: tuple[str, ...]
    method: str
    structure: str
    """Of the closed form; empty for the numeric method."""
    branches: int
    task: Task
    precision: Precision
    starts: Starts | None
    operations: Counter[str]
    """Of one call of the closed form, or of one step."""
    cycles: int
    """Estimate for one solve (numeric: the mean) on a Cortex-M4F."""
    cycles_most: int
    """Estimate for the longest solve seen."""
    cost: Cost
    fingerprint: int


def export_c(
    arm: Arm,
    folder: Path | str,
    *,
    method: str = "auto",
    precision: str = "single",
    task: Task = Task.POSE,
    target: str = "cortex-m4f",
    seed: int = 0,
) -> Export:
    """Write forward and inverse kinematics of `arm` as C99 into `folder`.

    `method` "auto" takes the closed form where the arm has one. Raises BadParameter, and
    UnknownStructure where a closed form is asked for and there is none.
    """
    if method not in METHODS:
        raise BadParameter("method", method, " or ".join(METHODS))
    if target not in TARGETS:
        raise BadParameter("target", target, " or ".join(TARGETS))
    real = precision_named(precision)
    folder = Path(folder)
    chain = _representable(arm.chain, real)
    closed = _closed_form(arm, task, method)
    kernels = [_kernel(symbolic.base_from_tool(chain), "vr_kernel_forward", ["q"], ["pose"], real)]
    step = _kernel(symbolic.lm_step(chain, task), "vr_kernel_step", ["q", "goal"], ["next", "error"], real)
    starts = None
    if closed is None:
        kernels.append(step)
        starts = covering_starts(chain, task, within=(real.reached_m, real.reached_rad), seed=seed)
        mean, most = (
            round(cycles(step.operations, real) * n) for n in (starts.steps_mean, starts.steps_most)
        )
    else:
        every = _kernel(_part(closed.function, "branches", 0), "vr_kernel_branches", ["goal"], ["q"], real)
        error = _kernel(_error(chain, task), "vr_kernel_error", ["q", "goal"], ["error"], real)
        kernels += [every, error, step]
        # One branch inside the limits, or all of them, is looked at; then the answer once more.
        mean = cycles(every.operations, real) + 2 * cycles(error.operations, real)
        most = mean + (closed.branches - 1) * cycles(error.operations, real)
    one = kernels[1].operations
    words = {"cycles": mean, "target": TARGETS[target], "cases": cases(arm.chain, real, seed)}
    fill = words_of(arm, chain, real, task, kernels, starts=starts, closed=closed) | words
    for name in PLAIN:
        write_text(folder / name, source(name))
    for name in WRITTEN:
        write_text(folder / name, rendered(name, fill))
    total = sum((kernel.operations for kernel in kernels), Counter())
    cost = measured(folder) or estimated(total, real)
    return Export(
        folder=folder,
        files=(*WRITTEN, *PLAIN),
        method="numeric" if closed is None else "closed-form",
        structure="" if closed is None else closed.structure,
        branches=0 if closed is None else closed.branches,
        task=task,
        precision=real,
        starts=starts,
        operations=one,
        cycles=mean,
        cycles_most=most,
        cost=cost,
        fingerprint=fingerprint(arm.chain),
    )


def _closed_form(arm: Arm, task: Task, method: str) -> "ClosedForm | None":
    """The arm's closed form where it is to be taken."""
    from vision_robot.arm.closed_form import closed_form_of

    if method == "numeric" or (method == "auto" and task is not Task.POSE):
        return None
    if task is not Task.POSE:
        raise BadParameter("task for a closed form", task.value, "pose; the numeric method does the others")
    try:
        return closed_form_of(arm.chain)
    except UnknownStructure:
        if method == "closed-form":
            raise
        return None


def _kernel(
    function: "Function", name: str, inputs: Sequence[str], outputs: Sequence[str], real: Precision
) -> StraightLine:
    return straight_line(function, name, inputs, outputs, real)


def _error(chain: SerialChain, task: Task) -> "Function":
    """Distance and angle to the goal alone, of the residual's three results."""
    return _part(symbolic.residual(chain, task), "error", 2)


def _part(function: "Function", name: str, output: int) -> "Function":
    """A function that gives one of the results only, so that nothing else is computed."""
    import casadi as ca

    symbols = function.sx_in()
    return ca.Function(name, symbols, [function.call(symbols)[output]])


def _representable(chain: SerialChain, real: Precision) -> SerialChain:
    """The chain with its limits rounded inwards to numbers of this precision."""
    if real.bytes == 8:
        return chain
    limits = chain.limits.astype(np.float32)
    low, high = limits.T
    low = np.where(low < chain.limits[:, 0], np.nextafter(low, np.float32(np.inf)), low)
    high = np.where(high > chain.limits[:, 1], np.nextafter(high, np.float32(-np.inf)), high)
    return replace(chain, limits=np.stack([low, high], axis=1).astype(float))
