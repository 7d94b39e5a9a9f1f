"""What the exported code costs: estimated from its operations, measured where a compiler is installed."""

import re
import shutil
import subprocess
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from vision_robot.arm.export_c.precision import Precision
from vision_robot.arm.export_c.starts import LAST_PATIENCE, PATIENCE, Starts

__all__ = [
    "COMPILER",
    "Cost",
    "Cycles",
    "closed_form_cycles",
    "cycles",
    "estimated",
    "measured",
    "numeric_cycles",
]

COMPILER = "arm-none-eabi-gcc"

CYCLES_SINGLE = {"add": 3, "mul": 3, "div": 17, "sqrt": 17, "select": 8, "fmin": 8, "fmax": 8, "fabs": 2}
"""Cycles of an operation on a Cortex-M4F (Cortex-M4 TRM r0p1, table 7-1), two more for loads and stores."""
CALL_SINGLE = 170
"""Of a function of math.h: newlib's sinf, cosf, atan2f and their like, roughly."""
CYCLES_DOUBLE, CALL_DOUBLE = 110, 3000
"""The M4F has no double arithmetic: every operation is a call of the compiler's own library."""
BYTES_SINGLE, BYTES_DOUBLE = 6, 17
"""Code of an operation in Thumb-2, with its loads and stores."""


@dataclass(frozen=True)
class Cost:
    """Bytes on the microcontroller."""

    source: str
    """Where the figures come from: the compiler's name, or "estimate"."""
    code: int
    """Instructions and constants of vr_ik.c."""
    data: int
    """Of vr_ik.c, what is not constant."""
    stack: int | None
    """Deepest use from vr_solve on, without math.h; None where it is not known."""
    link_code: int | None = None
    """Instructions and constants of vr_link.c."""


def cycles(operations: Mapping[str, int], precision: Precision) -> int:
    """Estimate of one call on a Cortex-M4F."""
    if precision.suffix:
        return sum(CYCLES_SINGLE.get(name, CALL_SINGLE) * count for name, count in operations.items())
    usual = set(CYCLES_SINGLE) - {"sqrt"}
    return sum((CYCLES_DOUBLE if name in usual else CALL_DOUBLE) * n for name, n in operations.items())


@dataclass(frozen=True)
class Cycles:
    """Estimates for one solve on a Cortex-M4F."""

    usual: int
    """Of a goal inside the limits: the mean."""
    most: int
    """Of the goal inside the limits that took longest."""
    given_up: int
    """At most, until a goal counts as out of reach."""


def closed_form_cycles(
    every: Mapping[str, int], error: Mapping[str, int], branches: int, precision: Precision
) -> Cycles:
    """One branch that lies inside the limits, or all of them, is looked at; then the answer once more."""
    usual = cycles(every, precision) + 2 * cycles(error, precision)
    most = usual + (branches - 1) * cycles(error, precision)
    return Cycles(usual, most, most)


def numeric_cycles(step: Mapping[str, int], starts: Starts, spread: int, precision: Precision) -> Cycles:
    """As many steps as the trial of the starts took; `spread` starts more where a goal is not reached."""
    each = cycles(step, precision)
    steps = 5 * (PATIENCE * (1 + len(starts.q)) + LAST_PATIENCE * spread)
    return Cycles(round(each * starts.steps_mean), each * starts.steps_most, each * steps)


def estimated(operations: Counter[str], precision: Precision) -> Cost:
    """From the number of operations alone."""
    per = BYTES_SINGLE if precision.suffix else BYTES_DOUBLE
    return Cost("estimate", 1400 + per * operations.total(), 0, None)


def measured(folder: Path) -> Cost | None:
    """Compile the exported files for their target and read what the compiler says; None without one."""
    if shutil.which(COMPILER) is None or shutil.which("make") is None:
        return None
    run = subprocess.run(["make", "size"], cwd=folder, capture_output=True, text=True, check=False)
    sizes = {}
    for line in run.stdout.splitlines():
        row = re.match(r"\s*(\d+)\s+(\d+)\s+(\d+)\s+\d+\s+[0-9a-f]+\s+(\S+)\.mcu\.o$", line)
        if row:
            sizes[row[4]] = tuple(int(row[i]) for i in (1, 2, 3))
    if run.returncode or not {"vr_ik", "vr_link"} <= set(sizes):
        return None
    text, data, bss = sizes["vr_ik"]
    return Cost(COMPILER, text, data + bss, _stack(run.stdout), sizes["vr_link"][0])


CALLS = {
    "vr_solve": ("vr_branches", "descend", "vr_kernel_error"),
    "descend": ("vr_kernel_step",),
    "vr_branches": ("vr_kernel_branches", "polish", "vr_kernel_error"),
    "polish": ("vr_kernel_step", "vr_kernel_error"),
}
"""Who calls whom in vr_ik.c; what the compiler has inlined is missing from its list, and counts nothing."""


def _stack(listing: str) -> int:
    own = {m[1]: int(m[2]) for m in re.finditer(r"vr_ik\.c:\d+:\d+:(\w+)\s+(\d+)\s+\w+", listing)}
    own |= {m[1]: int(m[2]) for m in re.finditer(r"vr_kernels\.h:\d+:\d+:(\w+)\s+(\d+)\s+\w+", listing)}

    def deepest(name: str) -> int:
        return own.get(name, 0) + max((deepest(callee) for callee in CALLS.get(name, ())), default=0)

    return deepest("vr_solve")
