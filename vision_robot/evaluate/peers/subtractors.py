"""OpenCV's background subtractors, with their own defaults, followed by blob analysis."""

from abc import abstractmethod
from typing import Any

import cv2

from vision_robot.evaluate.peers.mask_blobs import MaskBlobs
from vision_robot.types import Array, Bool, Image

__all__ = ["Cnt", "Gmg", "Gsoc", "Knn", "Lsbp", "Mog2"]

SHADOW = 127
"""What MOG2 and KNN write for shadows."""


class OpenCvSubtractor(MaskBlobs):
    """What a subtractor of OpenCV takes for foreground, shadows not."""

    def __init__(self, options: Any = None) -> None:
        super().__init__(options)
        self._subtractor = self.create()

    @abstractmethod
    def create(self) -> Any:
        """A subtractor that has seen nothing."""

    def raw(self, frame: Image) -> Bool[Array, "height width"]:
        """Foreground, shadows not."""
        return self._subtractor.apply(frame) > SHADOW


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
