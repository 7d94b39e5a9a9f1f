"""CamShift: the mode of a hue histogram's back projection (Bradski 1998)."""

import cv2
import numpy as np

from vision_robot.evaluate.peers.one_object import OneObject, blob_of_box
from vision_robot.track.blobs import Blobs
from vision_robot.types import Array, Image

__all__ = ["CamShift"]

STOP = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 10, 1.0)


class CamShift(OneObject):
    """OpenCV's CamShift as its own tutorial uses it: hue of well coloured pixels, 180 bins."""

    name = "cv2-camshift"

    def start(self, frame: Image, box: tuple[int, int, int, int]) -> None:
        """Learn the hue of what the box holds."""
        self._window = box
        left, top, width, height = box
        hsv, coloured = self._hue(frame)
        part = slice(max(0, top), top + height), slice(max(0, left), left + width)
        self._histogram = cv2.calcHist([hsv[part]], [0], coloured[part], [180], [0, 180])
        cv2.normalize(self._histogram, self._histogram, 0, 255, cv2.NORM_MINMAX)

    def follow(self, frame: Image) -> Blobs:
        """The mode of the back projection."""
        hsv, coloured = self._hue(frame)
        likely = cv2.calcBackProject([hsv], [0], self._histogram, [0, 180], 1)
        likely = cv2.bitwise_and(likely, coloured)
        (centre, size, angle), window = cv2.CamShift(likely, self._window, STOP)
        if not (min(window[2:]) > 0 and min(size) > 0):
            return Blobs.empty()  # lost; it looks again where it last was
        self._window = window
        # The angle is that of the first side, in degrees; the longer side is the axis.
        yaw = np.radians(angle + (0 if size[0] >= size[1] else 90))
        found = blob_of_box(
            np.array(window, dtype=float) - [0.5, 0.5, 0, 0],
            float((yaw + np.pi / 2) % np.pi - np.pi / 2),
            (max(size), min(size)),
        )
        return Blobs(
            np.array([centre], dtype=float), found.box_px, found.area_px, found.axes_px, found.yaw_rad
        )

    def _hue(self, frame: Image) -> tuple[Array, Array]:
        hsv = cv2.cvtColor(frame, cv2.COLOR_BGR2HSV)
        return hsv, cv2.inRange(hsv, np.array([0, 60, 32]), np.array([180, 255, 255]))
