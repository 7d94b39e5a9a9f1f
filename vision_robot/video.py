"""Videos, read and written one frame at a time."""

import errno
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import cv2
import numpy as np

from vision_robot import MOST_PIXELS
from vision_robot.errors import BadParameter, BadVideo, UnwritableOutput
from vision_robot.files import atomic_path
from vision_robot.reading import Refusal
from vision_robot.types import Image

__all__ = ["Frame", "Video", "VideoWriter", "open_video"]

CODECS = {".avi": "MJPG", ".mkv": "FFV1", ".mp4": "mp4v", ".webm": "VP90"}
"""What each container is written with; FFV1 in .mkv is lossless."""

PROBE_BYTES = 1 << 16
"""More than encoders keep back before they write."""

LIKELY_FPS = (1.0, 1000.0)


@dataclass(frozen=True)
class Frame:
    """One picture of a video: its number from 0, its time from the first [s], and its pixels."""

    index: int
    time_s: float
    image: Image


class Video:
    """The frames of a video file, streamed; iterate over it as often as wanted, each time from the start.

    Times are the file's own stamps, so a variable frame rate is kept; where stamps do not rise,
    they are replaced by ``index / fps``. Raises BadVideo where the file holds no frame.
    """

    def __init__(self, path: Path | str):
        self.path = Path(path)
        capture = self._open()
        try:
            readable, first = capture.read()
            if not readable:
                raise BadVideo(path, "no frame of it can be decoded")
            height, width = first.shape[:2]
            self.size = (int(width), int(height))
            fps = float(capture.get(cv2.CAP_PROP_FPS))
            self.fps = fps if LIKELY_FPS[0] <= fps <= LIKELY_FPS[1] else 25.0
            count = int(capture.get(cv2.CAP_PROP_FRAME_COUNT))
            self.frame_count: int | None = count if count > 0 else None
        finally:
            capture.release()

    def __iter__(self) -> Iterator[Frame]:
        capture = self._open()
        try:
            index, last = 0, -1.0
            while True:
                readable, image = capture.read()
                if not readable:
                    return
                if image.shape[1::-1] != self.size:
                    size, other = self.size, image.shape[1::-1]
                    raise BadVideo(
                        self.path,
                        f"frame {index} is {other[0]}x{other[1]} px and the first {size[0]}x{size[1]} px",
                    )
                time = float(capture.get(cv2.CAP_PROP_POS_MSEC)) / 1000
                if not time > last:
                    time = max(index / self.fps, last + 1e-3 / self.fps)
                yield Frame(index, time, image)
                index, last = index + 1, time
        finally:
            capture.release()

    def _open(self) -> cv2.VideoCapture:
        return open_video(self.path, BadVideo)


def open_video(path: Path, refuse: Refusal) -> cv2.VideoCapture:
    """OpenCV's reader of a plain file whose frames are not beyond all measure."""
    if not path.is_file():
        raise refuse(path, "it is not a plain file" if path.exists() else "there is no such file")
    if not _is_text(path):
        raise refuse(path, "its name is no text in UTF-8: rename it")
    capture = cv2.VideoCapture(str(path))
    width, height = (capture.get(side) for side in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT))
    if width * height > MOST_PIXELS:
        capture.release()
        raise refuse(path, f"its frames are {width:.0f}x{height:.0f} px, more than {MOST_PIXELS} in all")
    return capture


def _is_text(path: Path) -> bool:
    """Whether OpenCV can be given the name; others crash it."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        return False
    return True


class VideoWriter:
    """Writes a video that appears at `path` when its with block ends well, and not at all otherwise.

    The suffix chooses the codec (`CODECS`). Raises BadParameter for a suffix nobody can write
    or frames of another size, BadVideo where this machine's OpenCV lacks the codec.
    """

    def __init__(self, path: Path | str, size: tuple[int, int], fps: float):
        self.path, self.size, self.fps = Path(path), size, float(fps)
        if self.path.suffix.lower() not in CODECS:
            raise BadParameter("video file", str(path), f"named *{', *'.join(CODECS)}")
        if not _is_text(self.path):
            raise BadVideo(path, "its name is no text in UTF-8: choose another")
        if not (np.isfinite(self.fps) and self.fps > 0):
            raise BadParameter("fps", fps, "positive")

    def __enter__(self) -> Self:
        self._place = atomic_path(self.path)
        self._temporary = temporary = self._place.__enter__()
        code = cv2.VideoWriter.fourcc(*CODECS[self.path.suffix.lower()])
        self._writer = cv2.VideoWriter(str(temporary), code, self.fps, self.size)
        if not self._writer.isOpened():
            error = BadVideo(self.path, f"this OpenCV cannot write {self.path.suffix} files")
            self._place.__exit__(type(error), error, None)
            raise error
        return self

    def write(self, image: Image) -> None:
        """Append a frame, grey or blue-green-red."""
        if image.shape[1::-1] != self.size:
            raise BadParameter("frame size", image.shape[1::-1], f"{self.size}, the size of the video")
        colour = cv2.cvtColor(image, cv2.COLOR_GRAY2BGR) if image.ndim == 2 else image
        self._writer.write(np.ascontiguousarray(colour))

    def __exit__(self, *exception: object) -> None:
        self._writer.release()
        error = None if exception[0] else _no_room(self._temporary)
        if error is not None:
            refused = UnwritableOutput(self.path, error.strerror or str(error))
            self._place.__exit__(type(refused), refused, None)
            raise refused
        self._place.__exit__(*exception)  # type: ignore[arg-type]


def _no_room(path: Path) -> OSError | None:
    """Why the disk takes no more; OpenCV does not tell that its frames found no place."""
    size = path.stat().st_size
    try:
        with path.open("r+b", buffering=0) as file:
            file.seek(size)
            written = file.write(bytes(PROBE_BYTES))
            os.fsync(file.fileno())
            file.truncate(size)
        return None if written == PROBE_BYTES else OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    except OSError as error:
        return error
