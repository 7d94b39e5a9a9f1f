"""How a loop is closed: gain, heights, when it is done, and what lost sight means."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter

__all__ = ["LOST", "Servoing"]

LOST = ("predict", "hold", "abort")
"""What a law does while the label is out of sight: go on by the joints, stand still, or end at once."""


@dataclass(frozen=True)
class Servoing:
    """Settings of the laws; see each law for what it takes of them."""

    heights_m: tuple[float, ...] = (0.15, 0.02)
    """Over the thing's axis: where the label is looked at, one after the other."""
    turn_sigma_rad: float = np.radians(2.0)
    shift_sigma_m: float = 0.02
    """How far the camera may have been knocked, one standard deviation per axis, before it is looked at."""
    stop_m: float = 3.5e-4
    """Look-move-look ends when the place at the thing is known this well, one standard deviation."""
    enough_m: float = 2e-3
    """What is known worse than this when the label cannot be seen is no reason to go on."""
    most_looks: int = 8
    gain_per_s: float = 8.0
    """Of the continuous laws: the error falls to 1/e in its inverse."""
    compensate: bool = True
    """Take off an error what was commanded since its picture: latency then costs no stability."""
    most_seconds: float = 6.0
    """Of a continuous law at one height."""
    still_frames: int = 5
    """Pictures one after the other that show no more error than noise does, until a law is done."""
    lost: str = "predict"
    """One of `LOST`."""
    patience_s: float = 0.5
    """How long the label may be out of sight."""

    def __post_init__(self) -> None:
        if self.lost not in LOST:
            raise BadParameter("lost sight", self.lost, f"one of {', '.join(LOST)}")
        if not self.heights_m or not min(self.heights_m) > 0:
            raise BadParameter("heights of looks", self.heights_m, "one or more above 0 m")
        positive = ("turn_sigma_rad", "shift_sigma_m", "stop_m", "enough_m", "gain_per_s", "most_seconds")
        for name in positive:
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise BadParameter(f"servoing {name}", value, "positive")
        if min(self.most_looks, self.still_frames) < 1 or self.patience_s < 0:
            asked = (self.most_looks, self.still_frames, self.patience_s)
            raise BadParameter(
                "looks, still frames, patience", asked, "at least one, at least one, not negative"
            )
