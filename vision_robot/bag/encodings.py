"""What the samples of sensor_msgs/Image mean, by the names of ROS (REP 118 and image_encodings.hpp)."""

from typing import NamedTuple

import cv2
import numpy as np

__all__ = ["ENCODINGS", "Encoding"]


class Encoding(NamedTuple):
    """How the bytes of a pixel lie, and the way to grey or blue-green-red."""

    bits: int
    channels: int
    to_ours: int | None = None
    """OpenCV's conversion; None where samples are grey or blue-green-red already."""

    @property
    def pixel_bytes(self) -> int:
        """Bytes from one pixel of a row to the next."""
        return self.bits // 8 * self.channels

    def sample_type(self, *, big_endian: bool) -> np.dtype:
        """The numpy type of one sample."""
        return np.dtype(np.uint8) if self.bits == 8 else np.dtype(">u2" if big_endian else "<u2")


# OpenCV names a Bayer pattern by its second row's second and third pixel, ROS by its first two rows.
ENCODINGS: dict[str, Encoding] = {
    "mono8": Encoding(8, 1),
    "8UC1": Encoding(8, 1),
    "mono16": Encoding(16, 1),
    "16UC1": Encoding(16, 1),
    "bgr8": Encoding(8, 3),
    "8UC3": Encoding(8, 3),
    "rgb8": Encoding(8, 3, cv2.COLOR_RGB2BGR),
    "bgra8": Encoding(8, 4, cv2.COLOR_BGRA2BGR),
    "8UC4": Encoding(8, 4, cv2.COLOR_BGRA2BGR),
    "rgba8": Encoding(8, 4, cv2.COLOR_RGBA2BGR),
    "bgr16": Encoding(16, 3),
    "rgb16": Encoding(16, 3, cv2.COLOR_RGB2BGR),
    "bayer_rggb8": Encoding(8, 1, cv2.COLOR_BayerBG2BGR),
    "bayer_bggr8": Encoding(8, 1, cv2.COLOR_BayerRG2BGR),
    "bayer_gbrg8": Encoding(8, 1, cv2.COLOR_BayerGR2BGR),
    "bayer_grbg8": Encoding(8, 1, cv2.COLOR_BayerGB2BGR),
    "bayer_rggb16": Encoding(16, 1, cv2.COLOR_BayerBG2BGR),
    "bayer_bggr16": Encoding(16, 1, cv2.COLOR_BayerRG2BGR),
    "bayer_gbrg16": Encoding(16, 1, cv2.COLOR_BayerGR2BGR),
    "bayer_grbg16": Encoding(16, 1, cv2.COLOR_BayerGB2BGR),
    "yuv422": Encoding(8, 2, cv2.COLOR_YUV2BGR_UYVY),
    "uyvy": Encoding(8, 2, cv2.COLOR_YUV2BGR_UYVY),
    "yuv422_yuy2": Encoding(8, 2, cv2.COLOR_YUV2BGR_YUY2),
    "yuyv": Encoding(8, 2, cv2.COLOR_YUV2BGR_YUY2),
}
