"""Tracker `background-plain`: the text's form, kept to be compared with.

Background: the median of each pixel over the last frames; absolute difference; one threshold for all pixels;
blob analysis. Computed as it reads, with numpy's median over the whole window in every frame.
"""

from collections import deque
from dataclasses import dataclass
from typing import Any, ClassVar

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.track.blob_analysis import analyse
from vision_robot.track.blobs import Blobs
from vision_robot.track.tracker import Remark, Tracker
from vision_robot.types import Array, Image, UInt8

__all__ = ["BackgroundPlain", "BackgroundPlainOptions"]


@dataclass(frozen=True)
class BackgroundPlainOptions:
    """What can be asked of `background-plain`."""

    window: int = 25
    """Frames in the median."""
    threshold: float = 25.0
    """Grey levels by which an object differs from the background."""
    min_area_px: float = 50.0
    """Least area."""

    def __post_init__(self) -> None:
        if self.window < 1:
            raise BadParameter("background-plain.window", self.window, "1 or more")


class BackgroundPlain(Tracker):
    """``numpy.median`` over a window of grey frames, and a threshold."""

    name = "background-plain"
    Options: ClassVar[type[Any]] = BackgroundPlainOptions

    def __init__(self, options: BackgroundPlainOptions | None = None) -> None:
        self.options = options or BackgroundPlainOptions()
        self._window: deque[Array] = deque(maxlen=self.options.window)
        self._mask = np.zeros((0, 0), dtype=np.uint8)

    def find(self, frame: Image, time_s: float) -> Blobs:  # noqa: ARG002 - the protocol's signature
        """Objects in the next frame."""
        grey = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
        self._window.append(grey)
        background = np.median(np.stack(self._window), axis=0)
        self._mask = (np.abs(grey - background) > self.options.threshold).astype(np.uint8)
        return analyse(self._mask, axes="matlab", min_area_px=self.options.min_area_px)

    @property
    def mask(self) -> UInt8[Array, "height width"]:
        """Pixels taken for objects in the last frame."""
        return self._mask

    def remarks(self) -> tuple[Remark, ...]:
        """That nothing was chosen from the data."""
        threshold, area = self.options.threshold, self.options.min_area_px
        return (
            ("note", f"threshold {threshold:g} levels and least area {area:g} px as set, not from the data"),
        )

    def figures(self) -> dict[str, float]:
        """None beyond its options."""
        return {}
