"""Tracker `optical-flow-plain`: the text's form, kept to be compared with.

Horn and Schunck's velocity between the frame and one before; threshold: its mean over the frame and over
time; median filter; closing; blob analysis.
"""

from collections import deque
from dataclasses import dataclass
from typing import Any, ClassVar

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.flow import horn_schunck_sweeps
from vision_robot.track.blob_analysis import analyse
from vision_robot.track.blobs import Blobs
from vision_robot.track.tracker import Remark, Tracker
from vision_robot.types import Array, Image, UInt8

__all__ = ["OpticalFlowPlain", "OpticalFlowPlainOptions"]


@dataclass(frozen=True)
class OpticalFlowPlainOptions:
    """What can be asked of `optical-flow-plain`."""

    back: int = 1
    """Which frame to compare with: 1 the one before, N the Nth back."""
    alpha: float = 15.0
    """Weight of smoothness [grey levels]."""
    sweeps: int = 10
    """Sweeps of Horn and Schunck's iteration, each time from zero."""
    median_px: int = 5
    """Side of the median filter; odd."""
    closing_px: int = 7
    """Side of the square that closes gaps."""
    min_area_px: float = 50.0
    """Least area."""

    def __post_init__(self) -> None:
        for name in ("back", "sweeps", "closing_px"):
            if getattr(self, name) < 1:
                raise BadParameter(f"optical-flow-plain.{name}", getattr(self, name), "1 or more")
        if self.median_px < 1 or self.median_px % 2 == 0:
            raise BadParameter("optical-flow-plain.median_px", self.median_px, "odd")
        if not self.alpha > 0:
            raise BadParameter("optical-flow-plain.alpha", self.alpha, "positive")


class OpticalFlowPlain(Tracker):
    """A number of sweeps, and the mean velocity as threshold."""

    name = "optical-flow-plain"
    Options: ClassVar[type[Any]] = OpticalFlowPlainOptions

    def __init__(self, options: OpticalFlowPlainOptions | None = None) -> None:
        self.options = options or OpticalFlowPlainOptions()
        self._before: deque[Array] = deque(maxlen=self.options.back)
        self._mask = np.zeros((0, 0), dtype=np.uint8)
        self._threshold_px = 0.0
        self._frames = 0

    def find(self, frame: Image, time_s: float) -> Blobs:  # noqa: ARG002 - the protocol's signature
        """Objects in the next frame."""
        grey = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY).astype(np.float32)
        first = self._before[0] if self._before else None
        self._before.append(grey)
        if first is None:
            self._mask = np.zeros(grey.shape, dtype=np.uint8)
            return Blobs.empty()
        told = self.options
        speed = np.hypot(*horn_schunck_sweeps(first, grey, alpha=told.alpha, sweeps=told.sweeps))
        self._frames += 1
        self._threshold_px += (float(speed.mean()) - self._threshold_px) / self._frames
        mask = cv2.medianBlur((speed > self._threshold_px).astype(np.uint8), told.median_px)
        square = np.ones((told.closing_px,) * 2, np.uint8)
        self._mask = np.asarray(cv2.morphologyEx(mask, cv2.MORPH_CLOSE, square), dtype=np.uint8)
        return analyse(self._mask, axes="matlab", min_area_px=told.min_area_px)

    @property
    def mask(self) -> UInt8[Array, "height width"]:
        """Pixels taken for objects in the last frame."""
        return self._mask

    def remarks(self) -> tuple[Remark, ...]:
        """The threshold that the data gave."""
        return (("note", f"the mean velocity is {self._threshold_px:.2g} px from frame to frame"),)

    def figures(self) -> dict[str, float]:
        """The threshold."""
        return {"threshold_px": self._threshold_px}
