"""OpenCV's background subtractors, with their own defaults, followed by blob analysis."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.track.blob_analysis import analyse
from vision_robot.track.blobs import Blobs
from vision_robot.track.tracker import Remark, Tracker
from vision_robot.types import Array, Image, UInt8

__all__ = ["Cnt", "Gmg", "Gsoc", "Knn", "Lsbp", "Mog2", "SubtractorOptions"]

SHADOW = 127
"""What MOG2 and KNN write for shadows."""


@dataclass(frozen=True)
class SubtractorOptions:
    """What is done with a subtractor's mask."""

    min_area_px: float = 30.0
    """Smaller blobs are noise."""
    closing_px: int = 3
    """Side of the square that closes gaps; 0 for none."""

    def __post_init__(self) -> None:
        for name in ("min_area_px", "closing_px"):
            if not getattr(self, name) >= 0:
                raise BadParameter(name, getattr(self, name), "zero or positive")


class OpenCvSubtractor(Tracker):
    """Mask of an OpenCV subtractor, median filter, closing, blobs."""

    Options = SubtractorOptions

    def __init__(self, options: SubtractorOptions | None = None) -> None:
        self._options = options or SubtractorOptions()
        self._subtractor = self.create()
        self._mask = np.zeros((1, 1), np.uint8)

    @abstractmethod
    def create(self) -> Any:
        """A subtractor that has seen nothing."""

    def find(self, frame: Image, time_s: float) -> Blobs:  # noqa: ARG002 - they know no time
        """Blobs of the cleaned mask."""
        raw = self._subtractor.apply(frame)
        mask = cv2.medianBlur((raw > SHADOW).astype(np.uint8), 5)
        if self._options.closing_px:
            side = self._options.closing_px
            mask = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((side, side), np.uint8))
        self._mask = mask
        return analyse(mask, min_area_px=self._options.min_area_px)

    @property
    def mask(self) -> UInt8[Array, "height width"]:
        """The cleaned mask."""
        return self._mask

    def remarks(self) -> tuple[Remark, ...]:
        """Nothing: it does not say."""
        return ()

    def figures(self) -> dict[str, float]:
        """Nothing: it chooses nothing."""
        return {"min_area_px": self._options.min_area_px}


class Mog2(OpenCvSubtractor):
    """Mixture of Gaussians (Zivkovic 2004)."""

    name = "cv2-mog2"

    def create(self) -> Any:
        """With its own defaults."""
        return cv2.createBackgroundSubtractorMOG2()


class Knn(OpenCvSubtractor):
    """Nearest neighbours (Zivkovic & van der Heijden 2006)."""

    name = "cv2-knn"

    def create(self) -> Any:
        """With its own defaults."""
        return cv2.createBackgroundSubtractorKNN()


class Cnt(OpenCvSubtractor):
    """Counting of stable values."""

    name = "cv2-cnt"

    def create(self) -> Any:
        """With its own defaults."""
        return cv2.bgsegm.createBackgroundSubtractorCNT()


class Gmg(OpenCvSubtractor):
    """Statistical estimation and Bayesian segmentation (Godbehere et al. 2012)."""

    name = "cv2-gmg"

    def create(self) -> Any:
        """With its own defaults."""
        return cv2.bgsegm.createBackgroundSubtractorGMG(initializationFrames=20)


class Gsoc(OpenCvSubtractor):
    """OpenCV's GSOC."""

    name = "cv2-gsoc"

    def create(self) -> Any:
        """With its own defaults."""
        return cv2.bgsegm.createBackgroundSubtractorGSOC()


class Lsbp(OpenCvSubtractor):
    """Local SVD binary patterns (Guo, Xu & Qiang 2016)."""

    name = "cv2-lsbp"

    def create(self) -> Any:
        """With its own defaults."""
        return cv2.bgsegm.createBackgroundSubtractorLSBP()
