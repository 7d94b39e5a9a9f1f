"""The arm that a command is about, as its options name it."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    import numpy as np

    from vision_robot.arm import Arm

__all__ = ["ArmBase", "ArmFile", "ArmLimits", "ArmTool", "arm_of", "height_of", "joints_of"]

ArmFile = Annotated[
    str, typer.Option("--arm", help="MJCF or URDF file, or column: the arm that comes with the tool.")
]
ArmTool = Annotated[str | None, typer.Option("--tool", help="Site (MJCF) or link (URDF) that is the tool.")]
ArmBase = Annotated[str | None, typer.Option("--base", help="Body or link that is the base.")]
ArmLimits = Annotated[
    list[str] | None,
    typer.Option("--limit", help="Limits of a joint: d1=0..400mm, theta2=-150..150deg. May be repeated."),
]

UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "deg": 3.141592653589793 / 180, "rad": 1.0}
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"


def arm_of(source: str, tool: str | None, base: str | None, limits: Sequence[str] | None) -> "Arm":
    """The arm; what its file does not say and was assumed is told on stderr."""
    from vision_robot.arm import ARMS, read_arm
    from vision_robot_cli.output import note

    arm = read_arm(
        source if source in ARMS else Path(source),
        tool=tool,
        base=base,
        limits=dict(_limit(text) for text in limits or ()),
    )
    for said in arm.assumed:
        note(f"vr: {said}")
    return arm


def joints_of(text: str, arm: "Arm", option: str) -> "np.ndarray":
    """Joint values ``d1=100mm,theta2=30deg``; those not named are zero, or the nearest limit to it."""
    import numpy as np

    from vision_robot.errors import BadParameter

    chain = arm.chain
    values = np.clip(np.zeros(len(chain)), *chain.limits.T)
    for part in text.split(","):
        match = re.fullmatch(rf"\s*([^=\s]+)\s*=\s*({NUMBER})\s*(mm|cm|m|deg|rad)\s*", part)
        if not match or match[1] not in chain.joint_names:
            names = ", ".join(chain.joint_names)
            raise BadParameter(option, part.strip(), f"JOINT=VALUE with its unit, joints being {names}")
        index = chain.joint_names.index(match[1])
        if (match[3] in ("mm", "cm", "m")) != bool(chain.slides[index]):
            allowed = "mm, cm or m" if chain.slides[index] else "deg or rad"
            raise BadParameter(option, part.strip(), f"given in {allowed}")
        values[index] = float(match[2]) * UNITS[match[3]]
    return values


def height_of(text: str) -> float:
    """A height with its unit, above or below the base [m]."""
    from vision_robot.errors import BadParameter

    match = re.fullmatch(rf"\s*({NUMBER})\s*(mm|cm|m)\s*", text)
    if not match:
        raise BadParameter("--height", text, "a length with its unit, such as 100mm")
    return float(match[1]) * UNITS[match[2]]


def _limit(text: str) -> tuple[str, tuple[float, float]]:
    from vision_robot.errors import BadParameter

    match = re.fullmatch(rf"\s*([^=\s]+)\s*=\s*({NUMBER})\s*\.\.\s*({NUMBER})\s*(mm|cm|m|deg|rad)\s*", text)
    if not match or float(match[2]) > float(match[3]):
        raise BadParameter("--limit", text, "JOINT=LEAST..GREATEST with a unit, such as d1=0..400mm")
    return match[1], (float(match[2]) * UNITS[match[4]], float(match[3]) * UNITS[match[4]])
