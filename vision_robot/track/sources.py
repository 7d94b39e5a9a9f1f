"""Where frames come from: a file, a camera, an array, a generator."""

import time
from collections.abc import Iterable, Iterator
from pathlib import Path

import cv2
import numpy as np

from vision_robot.errors import BadFrame, BadVideo
from vision_robot.types import Array
from vision_robot.video import Frame, Video

__all__ = ["CameraStream", "Source", "frames_of"]

Source = Path | str | Array | Iterable[Frame] | Iterable[Array]

LOST = 20
"""Reads in a row without a picture after which a camera counts as unplugged."""

PAUSE_S = 0.05


class CameraStream:
    """Frames of a camera with their times of arrival; it ends in BadVideo when the camera falls silent."""

    def __init__(self, number: int):
        self.number = number
        self._capture = cv2.VideoCapture(number)
        readable, first = self._capture.read() if self._capture.isOpened() else (False, None)
        if not readable or first is None:
            self._capture.release()
            raise BadVideo(f"camera {number}", "it does not open: is it plugged in, and free?")
        self.size = (int(first.shape[1]), int(first.shape[0]))

    def __iter__(self) -> Iterator[Frame]:
        start, index, lost = time.monotonic(), 0, 0
        try:
            while True:
                readable, image = self._capture.read()
                if readable:
                    yield Frame(index, time.monotonic() - start, image)
                    index, lost = index + 1, 0
                    continue
                lost += 1
                if lost >= LOST:
                    raise BadVideo(f"camera {self.number}", f"it stopped giving frames after {index}")
                time.sleep(PAUSE_S)
        finally:
            self._capture.release()


def frames_of(source: Source, *, fps: float = 25.0) -> Iterator[Frame]:
    """Frames with times from anything: the path of a video, a (n, height, width, ...) array, an iterable.

    Pictures without times get those of `fps`. Raises BadVideo for files that are none, BadFrame where there
    is no frame at all.
    """
    if isinstance(source, str | Path):
        yield from Video(source)
        return
    index = -1
    for index, item in enumerate(source):
        yield item if isinstance(item, Frame) else Frame(index, index / fps, np.asarray(item))
    if index < 0:
        raise BadFrame(0, "there is none: the source is empty")
