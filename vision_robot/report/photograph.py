"""A picture as part of a page."""

from base64 import b64encode

from vision_robot.types import Image

__all__ = ["photograph"]

WIDTH_PX = 400


def photograph(image: Image, width_px: int = WIDTH_PX) -> str:
    """A picture as a data URI, made smaller where it is wider."""
    import cv2

    scale = min(1.0, width_px / image.shape[1])
    size = (max(1, round(image.shape[1] * scale)), max(1, round(image.shape[0] * scale)))
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    _, data = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, 80])
    return "data:image/jpeg;base64," + b64encode(data.tobytes()).decode()
