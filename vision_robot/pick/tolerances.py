"""When an episode counts as a success."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter

__all__ = ["Tolerances"]


@dataclass(frozen=True)
class Tolerances:
    """Bounds of the rungs; lifting 4 cm is robosuite's bound, holding one second comes on top."""

    reach_m: float = 0.012
    """Of the tool against the thing at closing (MuJoCo Playground's bound)."""
    lift_m: float = 0.04
    hold_s: float = 1.0
    place_m: float = 0.010
    place_yaw_rad: float = np.radians(10.0)

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (np.isfinite(value) and value > 0):
                raise BadParameter(f"tolerance {name}", value, "positive")
