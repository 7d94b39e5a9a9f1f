"""Options that say which arm: shared by the commands of `vr ik`."""

import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from vision_robot_cli import completions

if TYPE_CHECKING:
    from vision_robot.arm import Arm, Task

__all__ = ["ArmOption", "ArmSource", "Base", "Limit", "TaskName", "Tool", "Wrist", "arm_of", "task_of"]

ArmSource = Annotated[
    str,
    typer.Argument(
        metavar="ARM",
        help="MJCF or URDF file, or column: the arm that comes with the tool.",
        autocompletion=completions.arms,
    ),
]
ArmOption = Annotated[
    str,
    typer.Option(
        "--arm",
        help="MJCF or URDF file, or column: the arm that comes with the tool.",
        autocompletion=completions.arms,
    ),
]
Tool = Annotated[str | None, typer.Option("--tool", help="Site (MJCF) or link (URDF) that is the tool {T}.")]
Wrist = Annotated[str | None, typer.Option("--wrist", help="Site, body or link that is the wrist {W}.")]
Base = Annotated[str | None, typer.Option("--base", help="Body or link that is the base {B}.")]
Limit = Annotated[
    list[str] | None,
    typer.Option("--limit", help="A joint's range instead of the file's: d1=0..0.4m, theta2=-150..150deg."),
]
TaskName = Annotated[
    str,
    typer.Option("--task", help="What of a goal counts: pose, axis, tilt or position."),
]

UNITS = {"m": 1.0, "mm": 1e-3, "rad": 1.0, "deg": math.pi / 180}


def arm_of(
    source: str,
    tool: str | None = None,
    wrist: str | None = None,
    base: str | None = None,
    limit: Sequence[str] | None = None,
) -> "Arm":
    """The arm that these options name. Raises BadArm and BadParameter; notes what had to be assumed."""
    from vision_robot.arm import read_arm
    from vision_robot_cli.output import note

    limits = dict(limit_of(text) for text in limit or ())
    arm = read_arm(source, tool=tool, wrist=wrist, base=base, limits=limits)
    for sentence in arm.assumed:
        note(f"{source}: {sentence}")
    return arm


def limit_of(text: str) -> tuple[str, tuple[float, float]]:
    """Joint and range [m or rad] of ``d1=0..0.4m``."""
    from vision_robot.errors import BadParameter

    number = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)"
    match = re.fullmatch(rf"\s*([^=]+?)\s*=\s*{number}\s*\.\.\s*{number}\s*([a-z]+)\s*", text, re.IGNORECASE)
    if not match or match[4].lower() not in UNITS:
        allowed = "joint=least..greatest with m, mm, rad or deg, such as d1=0..0.4m or theta2=-150..150deg"
        raise BadParameter("--limit", text, allowed)
    unit = UNITS[match[4].lower()]
    low, high = float(match[2]) * unit, float(match[3]) * unit
    if not low < high:
        raise BadParameter("--limit", text, "a range whose first value is the lesser")
    return match[1], (low, high)


def task_of(name: str) -> "Task":
    """The task called `name`."""
    from vision_robot.arm import Task
    from vision_robot.errors import BadParameter

    names = [task.value for task in Task]
    if name not in names:
        raise BadParameter("--task", name, ", ".join(names))
    return Task(name)
