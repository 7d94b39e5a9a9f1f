"""OpenCV's trackers of one object, which are shown its box in the first frame."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.track.blobs import Blobs
from vision_robot.track.tracker import Remark, Tracker
from vision_robot.types import Array, Image, UInt8

__all__ = ["BoxOptions", "Csrt", "Kcf", "Mil", "OneObject", "blob_of_box"]


@dataclass(frozen=True)
class BoxOptions:
    """Where the object is in the first frame."""

    box_px: tuple[float, float, float, float] | None = None
    """Left, top, width, height."""

    def __post_init__(self) -> None:
        if self.box_px is not None and (len(self.box_px) != 4 or not min(self.box_px[2:]) > 0):
            raise BadParameter("box_px", self.box_px, "left, top, width and height, the last two positive")


class OneObject(Tracker):
    """A tracker that follows a box from frame to frame."""

    Options = BoxOptions

    def __init__(self, options: BoxOptions | None = None) -> None:
        self._options = options or BoxOptions()
        if self._options.box_px is None:
            raise BadParameter(
                f"{self.name}.box_px", None, "the object's box in the first frame: left,top,width,height"
            )
        self._started = False
        self._mask = np.zeros((1, 1), np.uint8)

    @abstractmethod
    def start(self, frame: Image, box: tuple[int, int, int, int]) -> None:
        """See the object for the first time."""

    @abstractmethod
    def follow(self, frame: Image) -> Blobs:
        """Where it is now."""

    def find(self, frame: Image, time_s: float) -> Blobs:  # noqa: ARG002 - they know no time
        """The object where it is now, or nothing."""
        if self._started:
            found = self.follow(frame)
        else:
            assert self._options.box_px is not None, "asked when it was made"
            left, top, width, height = self._options.box_px
            # OpenCV counts boxes from the first pixel's index, and so from half a pixel inside ours.
            box = (round(left + 0.5), round(top + 0.5), max(1, round(width)), max(1, round(height)))
            self.start(frame, box)
            self._started = True
            found = blob_of_box(np.array(box, dtype=float) - [0.5, 0.5, 0, 0])
        self._mask = np.zeros(frame.shape[:2], np.uint8)
        for left, top, width, height in np.rint(found.box_px + np.array([0.5, 0.5, 0, 0])).astype(int):
            self._mask[max(0, top) : top + height, max(0, left) : left + width] = 1
        return found

    @property
    def mask(self) -> UInt8[Array, "height width"]:
        """The filled box."""
        return self._mask

    def remarks(self) -> tuple[Remark, ...]:
        """Nothing: it does not say."""
        return ()

    def figures(self) -> dict[str, float]:
        """Nothing: it chooses nothing."""
        return {}


def blob_of_box(box: Array, yaw_rad: float = np.nan, axes_px: tuple[float, float] | None = None) -> Blobs:
    """A blob of which only the box is known, and perhaps its axis."""
    middle = box[:2] + box[2:] / 2
    axes = np.array([axes_px or (max(box[2:]), min(box[2:]))], dtype=float)
    return Blobs(middle[None], box[None], np.array([box[2] * box[3]]), axes, np.array([yaw_rad]))


class OpenCvBoxTracker(OneObject):
    """One of OpenCV's own."""

    @abstractmethod
    def create(self) -> Any:
        """A tracker that has seen nothing."""

    def start(self, frame: Image, box: tuple[int, int, int, int]) -> None:
        """Show it the box."""
        self._tracker = self.create()
        self._tracker.init(np.ascontiguousarray(frame), box)

    def follow(self, frame: Image) -> Blobs:
        """Its next box."""
        found, box = self._tracker.update(np.ascontiguousarray(frame))
        if not found:
            return Blobs.empty()
        return blob_of_box(np.array(box, dtype=float) - [0.5, 0.5, 0, 0])


class Csrt(OpenCvBoxTracker):
    """Discriminative correlation filter with reliability (Lukezic et al. 2017)."""

    name = "cv2-csrt"

    def create(self) -> Any:
        """With its own defaults."""
        return cv2.TrackerCSRT.create()


class Kcf(OpenCvBoxTracker):
    """Kernelized correlation filter (Henriques et al. 2015)."""

    name = "cv2-kcf"

    def create(self) -> Any:
        """With its own defaults."""
        return cv2.TrackerKCF.create()


class Mil(OpenCvBoxTracker):
    """Multiple instance learning (Babenko, Yang & Belongie 2009)."""

    name = "cv2-mil"

    def create(self) -> Any:
        """With its own defaults."""
        return cv2.TrackerMIL.create()
