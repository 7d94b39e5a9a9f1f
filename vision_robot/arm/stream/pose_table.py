"""Poses of the tool over time, for a microcontroller that solves for the joints itself."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3
from vision_robot.types import Array, Float

__all__ = ["PoseTable"]


@dataclass(frozen=True)
class PoseTable:
    """Where the tool is to be in the base, and when; times rise."""

    time_s: Float[Array, "n"]
    base_from_tool: SE3
    """A batch of n."""

    def __post_init__(self) -> None:
        time = np.asarray(self.time_s, dtype=float)
        if self.base_from_tool.batch != time.shape or time.ndim != 1:
            raise BadParameter(
                "poses for these times", self.base_from_tool.batch, f"as many as times, {len(time)}"
            )
        if not (np.isfinite(time).all() and (time >= 0).all() and (np.diff(time) > 0).all()):
            raise BadParameter("times of poses", time.tolist()[:9], "rising from 0 s or later")
        object.__setattr__(self, "time_s", time)

    def __len__(self) -> int:
        return len(self.time_s)
