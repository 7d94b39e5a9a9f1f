"""An arm's kinematics as a folder of C for a microcontroller."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from vision_robot.arm.export_c.cost import (
    Cost,
    Cycles,
    closed_form_cycles,
    estimated,
    measured,
    numeric_cycles,
)
from vision_robot.arm.export_c.fingerprint import fingerprint
from vision_robot.arm.export_c.kernels import kernels_of, representable
from vision_robot.arm.export_c.precision import Precision, precision_named
from vision_robot.arm.export_c.starts import Starts, covering_starts
from vision_robot.arm.export_c.words import SPREAD, cases, rendered, source, words_of
from vision_robot.arm.model import Arm
from vision_robot.arm.task import Task
from vision_robot.errors import BadParameter, UnknownStructure
from vision_robot.files import write_text

if TYPE_CHECKING:
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
    cycles: Cycles
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
    chain = representable(arm.chain, real)
    closed = _closed_form(arm, task, method)
    kernels = kernels_of(chain, task, real, closed)
    if closed is None:
        starts = covering_starts(chain, task, real=real, seed=seed)
        cycles = numeric_cycles(kernels["step"].operations, starts, SPREAD, real)
    else:
        starts = None
        cycles = closed_form_cycles(
            kernels["branches"].operations, kernels["error"].operations, closed.branches, real
        )
    words = {"cycles": cycles.usual, "target": TARGETS[target], "cases": cases(arm.chain, real, seed)}
    fill = words_of(arm, chain, real, task, kernels, starts=starts, closed=closed) | words
    for name in PLAIN:
        write_text(folder / name, source(name))
    for name in WRITTEN:
        write_text(folder / name, rendered(name, fill))
    total = sum((kernel.operations for kernel in kernels.values()), Counter())
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
        operations=kernels["step" if closed is None else "branches"].operations,
        cycles=cycles,
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
