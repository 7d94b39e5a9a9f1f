"""What JPEG leaves of a picture."""

import cv2
import numpy as np

from vision_robot.types import Image

__all__ = ["through_jpeg"]


def through_jpeg(image: Image, quality: int) -> Image:
    """The picture after JPEG at `quality` of 1 to 100; the very same one for 0."""
    if quality == 0:
        return image
    _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    decoded = cv2.imdecode(data, cv2.IMREAD_UNCHANGED)
    assert decoded is not None, "we encoded it ourselves"
    return np.ascontiguousarray(decoded)
