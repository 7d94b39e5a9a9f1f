"""Where frames come from: a file, a camera, an array, a generator."""

import time
from collections.abc import Iterable, Iterator
from pathlib import Path

import cv2
import numpy as np

from vision_robot.bag import Bag, is_bag
from vision_robot.errors import BadFrame, BadParameter, BadVideo
from vision_robot.types import Array
from vision_robot.video import Frame, Video

__all__ = ["CameraStream", "Recording", "Source", "frames_of", "open_recording"]

Recording = Video | Bag
"""What can be looked through again from its start."""

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


def open_recording(path: Path | str, topic: str | None = None) -> Recording:
    """A video file, or the topic of a ROS bag. Raises BadVideo, BadBag, BadParameter, MissingPackage."""
    if is_bag(path):
        return Bag(path, topic)
    if topic is not None:
        raise BadParameter("topic", topic, f"left out: {path} is no ROS bag")
    return Video(path)


def frames_of(source: Source, *, fps: float = 25.0) -> Iterator[Frame]:
    """Frames with times from anything: path of a video or bag, a (n, height, width, ...) array, any iterable.

    Pictures without times get those of `fps`. Raises BadVideo for files that are none, BadFrame where there
    is no frame at all.
    """
    if isinstance(source, str | Path):
        yield from open_recording(source)
        return
    index = -1
    for index, item in enumerate(source):
        yield item if isinstance(item, Frame) else Frame(index, index / fps, np.asarray(item))
    if index < 0:
        raise BadFrame(0, "there is none: the source is empty")
