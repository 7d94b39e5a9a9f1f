"""A message of ROS as a picture of ours."""

from typing import Any

import cv2
import numpy as np

from vision_robot.errors import BadFrame
from vision_robot.types import Image

from .encodings import ENCODINGS

__all__ = ["IMAGE", "IMAGE_TYPES", "PictureMessages"]

IMAGE = "sensor_msgs/msg/Image"
IMAGE_TYPES = (IMAGE, "sensor_msgs/msg/CompressedImage")

LARGEST_SIDE = 2**15
"""Pixels; what claims to be larger is damaged."""


class PictureMessages:
    """Turns the messages of one topic into 8 bits, grey or blue-green-red.

    Samples of 16 bits are scaled from the least of 10, 12, 14 or 16 bits that held all so far: brightness
    does not jump back from frame to frame.
    """

    def __init__(self) -> None:
        self._bits = 10

    def picture(self, message: Any, index: int) -> Image:
        """The picture in a sensor_msgs Image or CompressedImage. Raises BadFrame."""
        samples = self._raw(message, index) if hasattr(message, "encoding") else self._packed(message, index)
        return self._eight_bits(samples)

    def _raw(self, message: Any, index: int) -> np.ndarray:
        encoding = ENCODINGS.get(message.encoding)
        if encoding is None:
            known = ", ".join(ENCODINGS)
            raise BadFrame(index, f"its encoding is {message.encoding!r}: it must be one of {known}")
        height, width, step = int(message.height), int(message.width), int(message.step)
        row = width * encoding.pixel_bytes
        if not (0 < height <= LARGEST_SIDE and 0 < width <= LARGEST_SIDE and step >= row):
            raise BadFrame(index, f"it claims {width}x{height} px in rows of {step} bytes")
        data = np.asarray(message.data, dtype=np.uint8)
        if len(data) < height * step:
            raise BadFrame(index, f"it holds {len(data)} bytes of {height * step}")
        rows = np.ascontiguousarray(data[: height * step].reshape(height, step)[:, :row])
        kind = encoding.sample_type(big_endian=bool(message.is_bigendian))
        samples = rows.view(kind).astype(kind.newbyteorder("="), copy=False)
        if encoding.channels > 1:
            samples = samples.reshape(height, width, encoding.channels)
        if encoding.to_ours is None:
            return samples
        try:
            return np.asarray(cv2.cvtColor(samples, encoding.to_ours))
        except cv2.error as error:  # Bayer and YUV patterns need even sizes of at least a few pixels
            raise BadFrame(index, f"{width}x{height} px cannot be {message.encoding}") from error

    def _packed(self, message: Any, index: int) -> np.ndarray:
        data = np.asarray(message.data, dtype=np.uint8)
        try:
            image = cv2.imdecode(data, cv2.IMREAD_UNCHANGED) if len(data) else None
        except (cv2.error, MemoryError):
            image = None
        if image is None or image.dtype not in (np.uint8, np.uint16):
            raise BadFrame(index, f"its data, said to be {message.format!r}, cannot be decoded")
        return image[..., :3] if image.ndim == 3 else image

    def _eight_bits(self, samples: np.ndarray) -> Image:
        if samples.dtype == np.uint8:
            return np.ascontiguousarray(samples)
        most = int(samples.max())
        self._bits = max(self._bits, next(bits for bits in (10, 12, 14, 16) if most < 2**bits))
        return (samples >> (self._bits - 8)).astype(np.uint8)
