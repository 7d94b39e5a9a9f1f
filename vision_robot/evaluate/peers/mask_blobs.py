"""What peers that answer with a mask have in common: median filter, closing, blob analysis."""

from abc import abstractmethod
from dataclasses import dataclass, fields
from typing import Any

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.track.blob_analysis import analyse
from vision_robot.track.blobs import Blobs
from vision_robot.track.tracker import Remark, Tracker
from vision_robot.types import Array, Bool, Image, UInt8

__all__ = ["MaskBlobs", "MaskOptions"]


@dataclass(frozen=True)
class MaskOptions:
    """What is done with a mask."""

    min_area_px: float = 30.0
    """Smaller blobs are noise."""
    closing_px: int = 3
    """Side of the square that closes gaps; 0 for none."""

    def __post_init__(self) -> None:
        for one in fields(self):
            if not getattr(self, one.name) >= 0:
                raise BadParameter(one.name, getattr(self, one.name), "zero or positive")


class MaskBlobs(Tracker):
    """Blobs of a mask that another method makes of each frame."""

    Options = MaskOptions

    def __init__(self, options: Any = None) -> None:
        self._options = options or self.Options()
        self._mask = np.zeros((1, 1), np.uint8)

    @abstractmethod
    def raw(self, frame: Image) -> Bool[Array, "height width"]:
        """The method's own mask of the next frame."""

    def find(self, frame: Image, time_s: float) -> Blobs:  # noqa: ARG002 - they know no time
        """Blobs of the cleaned mask."""
        mask = cv2.medianBlur(self.raw(frame).view(np.uint8), 5)
        if self._options.closing_px:
            side = self._options.closing_px
            mask = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((side, side), np.uint8))
        self._mask = np.asarray(mask, dtype=np.uint8)
        return analyse(self._mask, min_area_px=self._options.min_area_px)

    @property
    def mask(self) -> UInt8[Array, "height width"]:
        """The cleaned mask."""
        return self._mask

    def remarks(self) -> tuple[Remark, ...]:
        """Nothing: it does not say."""
        return ()

    def figures(self) -> dict[str, float]:
        """What it was told: it chooses nothing."""
        return {"min_area_px": self._options.min_area_px}
