"""The door every frame goes through: 8 bits, three channels, one size, rising time."""

import cv2
import numpy as np

from vision_robot.errors import BadFrame
from vision_robot.types import Array, Image

__all__ = ["Admission"]

BITS = (8, 10, 12, 14, 16)


class Admission:
    """Converts the frames of one video to (height, width, 3) of 8 bits, and refuses what does not belong."""

    def __init__(self) -> None:
        self._size: tuple[int, int] | None = None
        self._time_s = -np.inf
        self._bits = 0
        self._count = 0

    def admit(self, frame: Array, time_s: float) -> Image:
        """The frame as trackers want it; the same array where nothing is to be done. Raises BadFrame."""
        image = self.converted(frame)
        size = (image.shape[1], image.shape[0])
        if self._size not in (None, size):
            first = "{}x{}".format(*self._size)  # pyright: ignore[reportOptionalIterable]
            why = f"it is {size[0]}x{size[1]} px and those before are {first} px"
            raise BadFrame(self._count, f"{why}: scale them all to one size")
        if not time_s > self._time_s:
            why = f"its time, {time_s:g} s, does not come after {self._time_s:g} s: give rising times"
            raise BadFrame(self._count, why)
        self._size, self._time_s = size, time_s
        self._count += 1
        return image

    def converted(self, frame: Array) -> Image:
        """A grey, 16-bit or transparent frame as 8-bit blue-green-red, without looking at those before."""
        frame = np.asarray(frame)
        if frame.ndim not in (2, 3) or 0 in frame.shape:
            raise BadFrame(self._count, f"its shape is {frame.shape}: give (height, width) or (…, channels)")
        if frame.dtype == np.uint16:
            frame = self._eight_bits(frame)
        if frame.dtype != np.uint8:
            raise BadFrame(self._count, f"its samples are {frame.dtype}: give 8 or 16 bits without sign")
        channels = 1 if frame.ndim == 2 else frame.shape[2]
        if channels == 3:
            return np.ascontiguousarray(frame)
        if channels == 1:
            return np.asarray(cv2.cvtColor(np.ascontiguousarray(frame), cv2.COLOR_GRAY2BGR), dtype=np.uint8)
        if channels == 4:
            return np.ascontiguousarray(frame[..., :3])
        raise BadFrame(self._count, f"it has {channels} channels: give 1, 3 or 4")

    def _eight_bits(self, frame: Array) -> Image:
        # Once more bits were seen they stay: brightness must not jump back.
        self._bits = max(self._bits, next(bits for bits in BITS if int(frame.max()) < 2**bits))
        return (frame >> (self._bits - 8)).astype(np.uint8)
