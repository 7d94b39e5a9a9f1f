"""Joint values and heights on the command line."""

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

    from vision_robot.arm import Arm

__all__ = ["NUMBER", "UNITS", "height_of", "joints_of"]

UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "deg": 3.141592653589793 / 180, "rad": 1.0}
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"


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
