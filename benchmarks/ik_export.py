"""The exported C: size, stack, instructions, answers and speed, for arms of three kinds.

For each arm, method and precision: bytes of code and of stack by arm-none-eabi-gcc -Os for a Cortex-M4F;
instructions of one solve counted under qemu-arm; goals drawn inside the limits and solved from joints
drawn as well, on this computer (gcc -O2, one core) and on the emulated Cortex-M4F; how many were reached
inside the limits and how far the tool is from them by numpy's kinematics. Where cross compiler or emulator
are not installed those columns stay empty.
"""

import argparse
import math
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from table import markdown, shown

from vision_robot.arm import Arm, read_arm
from vision_robot.arm.export_c import export_c
from vision_robot.arm.export_c.emulation import available, instructions_per_solve, solve_emulated
from vision_robot.errors import UnknownStructure
from vision_robot.geometry import SE3, SerialChain
from vision_robot.types import Array, Float

RIGHT = math.pi / 2
UR5E = [
    (0, RIGHT, 0.1625),
    (-0.425, 0, 0),
    (-0.3922, 0, 0),
    (0, RIGHT, 0.1333),
    (0, -RIGHT, 0.0997),
    (0, 0, 0.0996),
]
PUMA = [
    (0, RIGHT, 0),
    (0.4318, 0, 0),
    (0.0203, -RIGHT, 0.15005),
    (0, RIGHT, 0.4318),
    (0, -RIGHT, 0),
    (0, 0, 0),
]
"""(a, alpha, d): Universal Robots' data sheet; Corke and Armstrong-Helouvry 1994."""

TIMED = """#include <stdio.h>
#include <time.h>
#include "vr_arm.h"
static vr_real asked[COUNT][12 + VR_JOINTS], q[COUNT][VR_JOINTS], error[COUNT][2];
static int reached[COUNT];
int main(void)
{
    double x;
    int k, i;
    clock_t start;
    for (k = 0; k < COUNT; k++)
        for (i = 0; i < 12 + VR_JOINTS; i++) {
            if (scanf("%lf", &x) != 1)
                return 1;
            asked[k][i] = (vr_real)x;
        }
    start = clock();
    for (k = 0; k < COUNT; k++)
        reached[k] = vr_solve(asked[k], asked[k] + 12, q[k], error[k]);
    printf("%.9g\\n", (double)(clock() - start) / CLOCKS_PER_SEC);
    for (k = 0; k < COUNT; k++) {
        printf("%d", reached[k]);
        for (i = 0; i < VR_JOINTS; i++)
            printf(" %.17g", (double)q[k][i]);
        printf("\\n");
    }
    return 0;
}
"""

COLUMNS = (
    "arm", "method", "precision", "code B", "stack B", "instructions", "host: reached", "worst mm",
    "solves/s", "M4F: reached", "worst mm",
)  # fmt: skip


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--goals", type=int, default=40_000, help="solved on this computer")
    parser.add_argument("--emulated", type=int, default=1000, help="solved on the emulated core")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quick", action="store_true", help="few goals of one arm: only to see that it runs")
    options = parser.parse_args()
    arms = {
        "column (ours)": read_arm("column"),
        "UR5e": turning("UR5e", UR5E),
        "Puma 560": turning("Puma 560", PUMA),
    }
    if options.quick:
        options.goals, options.emulated = 200, 20
        arms = {"column (ours)": arms["column (ours)"]}
    figures = []
    for name, arm in arms.items():
        for method in ("closed-form", "numeric"):
            for precision in ("single", "double"):
                figures.append({"arm": name} | measured(arm, method, precision, options))
    rows = [[cell(figure.get(key)) for key in FIGURES] for figure in figures]
    print(shown("vr.benchmark.ik_export/1", figures, markdown(COLUMNS, rows), as_json=options.json))


FIGURES = (
    "arm", "method", "precision", "code_bytes", "stack_bytes", "instructions", "reached", "worst_mm",
    "solves_per_s", "emulated_reached", "emulated_worst_mm",
)  # fmt: skip


def measured(arm: Arm, method: str, precision: str, options: argparse.Namespace) -> dict[str, object]:
    """All figures of one export."""
    rng = np.random.default_rng(options.seed)
    low, high = arm.chain.limits.T
    q, now = rng.uniform(low, high, (2, options.goals, len(arm)))
    goals = arm.chain.base_from_tool(q).as_matrix()[:, :3].reshape(-1, 12)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            export = export_c(arm, folder, method=method, precision=precision)
        except UnknownStructure:
            return {"method": method, "precision": precision}
        answer: dict[str, object] = {"method": method, "precision": precision, "code_bytes": export.cost.code}
        answer["cost_by"] = export.cost.source
        answer["stack_bytes"] = export.cost.stack
        answer["cycles_estimate"] = export.cycles.usual
        if shutil.which("gcc"):
            seconds, solved = on_this_computer(folder, goals, now)
            answer |= judged(arm, q, solved, "") | {"solves_per_s": len(goals) / seconds}
        if available():
            few = slice(options.emulated if precision == "single" else max(20, options.emulated // 10))
            solved = solve_emulated(folder, goals[few], now[few])[:, : 1 + len(arm)]
            answer |= judged(arm, q[few], solved, "emulated_")
            counted = slice(40 if precision == "single" else 4)
            answer["instructions"] = instructions_per_solve(folder, goals[counted], now[counted])
    return answer


def on_this_computer(
    folder: Path, goals: Float[Array, "k 12"], now: Float[Array, "k n"]
) -> tuple[float, Float[Array, "k m"]]:
    """CPU seconds, and rows of reached and joints."""
    (folder / "timed.c").write_text(TIMED)
    flags = ["-O2", "-std=c99", "-D_POSIX_C_SOURCE=199309L", f"-DCOUNT={len(goals)}"]
    subprocess.run(["gcc", *flags, "timed.c", "vr_ik.c", "-o", "timed", "-lm"], cwd=folder, check=True)
    lines = "\n".join(" ".join(map(repr, row)) for row in np.hstack([goals, now]).tolist())
    run = subprocess.run(["./timed"], cwd=folder, input=lines, capture_output=True, text=True, check=True)
    first, *rest = run.stdout.splitlines()
    return float(first), np.loadtxt(rest, ndmin=2)


def judged(arm: Arm, q: Float[Array, "k n"], solved: Float[Array, "k m"], prefix: str) -> dict[str, object]:
    """Share reached inside the limits, and the worst distance of those [mm]."""
    chain, joints = arm.chain, solved[:, 1:]
    reached = (solved[:, 0] == 1) & chain.within_limits(joints)
    missed = chain.base_from_tool(joints).inverse() @ chain.base_from_tool(q)
    worst = 1e3 * float(np.linalg.norm(missed.translation, axis=1)[reached].max(initial=0))
    return {f"{prefix}goals": len(q), f"{prefix}reached": float(reached.mean()), f"{prefix}worst_mm": worst}


def turning(name: str, rows: list[tuple[float, float, float]]) -> Arm:
    """Six turning joints by Denavit and Hartenberg's (a, alpha, d), a turn either way."""
    after = [SE3.from_rotvec(np.array([alpha, 0, 0]), np.array([a, 0, d])) for a, alpha, d in rows]
    links = [SE3.identity(), *after[:-1]]
    chain = SerialChain(
        joint_names=tuple(f"q{i + 1}" for i in range(len(rows))),
        slides=np.zeros(len(rows), dtype=bool),
        axes=np.tile([0.0, 0, 1], (len(rows), 1)),
        link_from_joint=SE3(np.array([f.rotation for f in links]), np.array([f.translation for f in links])),
        last_from_wrist=after[-1],
        limits=np.tile([-np.pi, np.pi], (len(rows), 1)),
        wrist_from_tool=SE3.identity(),
    )
    return Arm(name=name, chain=chain, base="base", tool="flange")


def cell(value: object) -> str:
    """A figure as the table has it."""
    if not isinstance(value, float):
        return "" if value is None else str(value)
    if value == 1.0:
        return "100 %"
    if 0.5 < value < 1:
        return f"{100 * value:.3f} %"
    return f"{value:.2g}" if value < 0.5 else f"{value:.0f}"


if __name__ == "__main__":
    main()
