"""`vr ik export`: the arm's kinematics as C for a microcontroller."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vision_robot_cli.arm_choice import ArmSource, Base, Limit, TaskName, Tool, Wrist, arm_of, task_of
from vision_robot_cli.options import Json, Seed

if TYPE_CHECKING:
    from vision_robot.arm.export_c import Export

__all__ = ["ik_export"]


def ik_export(
    arm: ArmSource = "column",
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the C files.")] = Path("arm_c"),
    method: Annotated[
        str,
        typer.Option(help="closed-form, numeric, or auto: the closed form where the arm has one."),
    ] = "auto",
    precision: Annotated[
        str, typer.Option(help="single or double. A Cortex-M4F computes only singles in hardware.")
    ] = "single",
    target: Annotated[str, typer.Option(help="What the Makefile compiles for: cortex-m4f.")] = "cortex-m4f",
    task: TaskName = "pose",
    tool: Tool = None,
    wrist: Wrist = None,
    base: Base = None,
    limit: Limit = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Write forward and inverse kinematics as C99: no heap, nothing of the library but math.h.

    Sizes and stack are measured where arm-none-eabi-gcc is installed, else estimated; cycles are estimated.

    Example: vr ik export my_arm.xml -o firmware/ik --precision single
    """
    from vision_robot.arm.export_c import export_c
    from vision_robot_cli.output import emit_json

    robot = arm_of(arm, tool, wrist, base, limit)
    export = export_c(
        robot, out, method=method, precision=precision, task=task_of(task), target=target, seed=seed
    )
    if json:
        emit_json("ik.export", figures(export))
    else:
        print("\n".join(told(export)))


def figures(export: "Export") -> dict[str, object]:
    """The keys of `--json`."""
    starts = export.starts
    return {
        "out": str(export.folder),
        "files": export.files,
        "method": export.method,
        "structure": export.structure or None,
        "branches": export.branches or None,
        "task": export.task.value,
        "precision": export.precision.name,
        "fingerprint": f"{export.fingerprint:08x}",
        "measured_by": export.cost.source,
        "code_bytes": export.cost.code,
        "data_bytes": export.cost.data,
        "stack_bytes": export.cost.stack,
        "link_code_bytes": export.cost.link_code,
        "operations": dict(export.operations),
        "cycles_estimate": export.cycles.usual,
        "cycles_most_estimate": export.cycles.most,
        "cycles_given_up_estimate": export.cycles.given_up,
        "starts": None
        if starts is None
        else {
            "count": len(starts.q),
            "goals": starts.goals,
            "reached": starts.reached,
            "steps_mean": starts.steps_mean,
        },
    }


def told(export: "Export") -> list[str]:
    """The lines for a person."""
    cost = export.cost
    how = "closed form" if export.starts is None else "damped steps"
    kind = f" ({export.structure}, {export.branches} branches)" if export.branches else ""
    words = f"{export.precision.name} precision, task {export.task.value}"
    lines = [f"{export.folder}: {len(export.files)} files; {how}{kind}, {words}"]
    measured = f"measured with {cost.source}" if cost.source != "estimate" else "estimated"
    stack = "" if cost.stack is None else f", stack {cost.stack} B"
    link = "" if cost.link_code is None else f"; serial receiver {cost.link_code} B"
    lines.append(f"vr_ik.c on a Cortex-M4F: code {cost.code} B, data {cost.data} B{stack}{link} ({measured})")
    counts = ", ".join(f"{count} {name}" for name, count in export.operations.most_common())
    lines.append(f"one {'solution' if export.starts is None else 'step'}: {counts}")
    cycles = export.cycles
    if export.starts is None:
        lines.append(
            f"one solve: about {cycles.usual} to {cycles.most} cycles (estimated from the operations)"
        )
    else:
        starts = export.starts
        share = f"{starts.reached} of {starts.goals} goals drawn inside the limits"
        lines.append(
            f"starts: {len(starts.q)} in the table, which reach {share}; more follow where these do not"
        )
        lines.append(
            f"one solve: about {cycles.usual} cycles in the mean, {cycles.most} at most seen (estimated)"
        )
        lines.append(f"a goal out of reach is given up after at most {cycles.given_up} cycles (estimated)")
    lines.append(f"try it: make -C {export.folder} test")
    return lines
