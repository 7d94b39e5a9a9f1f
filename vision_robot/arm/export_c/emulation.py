"""The exported code run as the microcontroller would run it, on a computer under qemu-arm."""

import shutil
import subprocess
from pathlib import Path

import numpy as np

from vision_robot.arm.export_c.cost import COMPILER
from vision_robot.types import Array, Float

__all__ = ["EMULATOR", "available", "instructions_per_solve", "solve_emulated"]

EMULATOR = ("qemu-arm", "-cpu", "cortex-a15")
"""Runs Thumb-2 and single-precision code of a Cortex-M4F: its instructions are a part of this core's."""


def available() -> bool:
    """Whether compiler, make and emulator are installed."""
    return all(shutil.which(tool) for tool in (COMPILER, "make", EMULATOR[0]))


def solve_emulated(
    folder: Path, goals: Float[Array, "k 12"], now: Float[Array, "k n"]
) -> Float[Array, "k m"]:
    """What filter.c answers on the emulated core: reached, joints, distance [m], angle [rad]."""
    subprocess.run(["make", "filter.elf"], cwd=folder, check=True, capture_output=True)
    lines = "\n".join(" ".join(map(repr, row)) for row in np.hstack([goals, now]).tolist())
    run = subprocess.run(
        [*EMULATOR, "filter.elf"], cwd=folder, input=lines + "\n", text=True, check=True, capture_output=True
    )
    return np.loadtxt(run.stdout.splitlines(), ndmin=2)


COUNTED = """#include "vr_arm.h"
static const vr_real asked[{count}][12 + VR_JOINTS] = {{
{rows}
}};
int main(void)
{{
    vr_real q[VR_JOINTS], error[2];
    int k, sum = 0;
    for (k = 0; k < SOLVES; k++)
        sum += vr_solve(asked[k], asked[k] + 12, q, error);
    return sum != SOLVES;
}}
"""


def instructions_per_solve(folder: Path, goals: Float[Array, "k 12"], now: Float[Array, "k n"]) -> float:
    """Mean number of instructions, math.h's included, that `vr_solve` takes for these goals.

    Two runs that differ in the number of solves alone are compared, so that start-up cancels.
    """
    rows = ",\n".join("{" + ", ".join(map(repr, row)) + "}" for row in np.hstack([goals, now]).tolist())
    (folder / "count.c").write_text(COUNTED.format(count=len(goals), rows=rows), encoding="utf-8")
    counts = []
    for solves in (0, len(goals)):
        elf, log = folder / "count.elf", folder / "count.log"
        elf.unlink(missing_ok=True)
        make = ["make", "count.elf", f"LINKED=-DSOLVES={solves}"]
        subprocess.run(make, cwd=folder, check=True, capture_output=True)
        traced = [*EMULATOR, "-singlestep", "-d", "exec,nochain", "-D", log.name, elf.name]
        subprocess.run(traced, cwd=folder, check=True, capture_output=True)
        with log.open("rb") as lines:
            counts.append(sum(1 for line in lines if line.startswith(b"Trace")))
        log.unlink()
    return (counts[1] - counts[0]) / len(goals)
