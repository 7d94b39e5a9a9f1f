"""Frames with what was seen drawn on them."""

from collections import deque

import cv2
import numpy as np

from vision_robot.tracks import Tracks
from vision_robot.types import Array, Image, UInt8

__all__ = ["Overlay"]

TRAIL = 40
"""Places of an object that its trail shows."""

MASK_BGR = np.array([40, 110, 255], dtype=np.float32)


class Overlay:
    """Draws masks, boxes, axes, ids and trails; remembers the trails."""

    def __init__(self) -> None:
        self._trails: dict[int, deque[tuple[float, float]]] = {}

    def draw(
        self, frame: Image, mask: UInt8[Array, "height width"], rows: Tracks, placed: Tracks | None = None
    ) -> Image:
        """A copy of the frame with the mask tinted and each row's object marked.

        `placed` are the same rows on the work plane, for labels in millimetres.
        """
        picture = frame.copy()
        inside = mask > 0
        if inside.any():
            picture[inside] = (0.55 * picture[inside] + 0.45 * MASK_BGR).astype(np.uint8)
        thick = max(1, round(frame.shape[1] / 800))
        for i in range(len(rows)):
            self._object(picture, rows, i, thick, placed)
        for gone in set(self._trails) - set(rows.id.tolist()):
            del self._trails[gone]
        return picture

    def _object(self, picture: Image, rows: Tracks, i: int, thick: int, placed: Tracks | None) -> None:
        one = int(rows.id[i])
        colour = colour_of(one)
        u, v = rows.centroid_px[i]
        trail = self._trails.setdefault(one, deque(maxlen=TRAIL))
        trail.append((float(u), float(v)))
        cv2.polylines(picture, [_fixed(np.array(trail))], False, colour, thick, cv2.LINE_AA, 3)
        left, top, width, height = rows.box_px[i]
        corners = np.array([[left, top], [left + width, top + height]])
        (a, b), (c, d) = _fixed(corners).tolist()
        cv2.rectangle(picture, (a, b), (c, d), colour, thick, cv2.LINE_AA, 3)
        if np.isfinite(rows.yaw_rad[i]):
            half = rows.axes_px[i, 0] / 2 * np.array([np.cos(rows.yaw_rad[i]), np.sin(rows.yaw_rad[i])])
            (a, b), (c, d) = _fixed(
                np.stack([rows.centroid_px[i] - half, rows.centroid_px[i] + half])
            ).tolist()
            cv2.line(picture, (a, b), (c, d), (255, 255, 255), thick, cv2.LINE_AA, 3)
        label = f"{one}"
        if placed is not None and np.isfinite(placed.position_m[i]).all():
            x, y = 1e3 * placed.position_m[i]
            label += f" {x:.1f}, {y:.1f} mm"
        place = (int(left), max(int(top) - 3, 10))
        cv2.putText(
            picture,
            label,
            place,
            cv2.FONT_HERSHEY_SIMPLEX,
            0.45 * thick,
            (0, 0, 0),
            2 * thick + 1,
            cv2.LINE_AA,
        )
        for shade, width in (((0, 0, 0), 2 * thick + 1), (colour, thick)):
            face, scale = cv2.FONT_HERSHEY_SIMPLEX, 0.45 * thick
            cv2.putText(picture, label, place, face, scale, shade, width, cv2.LINE_AA)


def colour_of(one: int) -> tuple[int, int, int]:
    """A colour for each id, neighbours far apart on the wheel (the golden ratio's steps)."""
    hue = int(180 * (one * 0.61803398875 % 1))
    blue, green, red = cv2.cvtColor(np.uint8([[[hue, 200, 255]]]), cv2.COLOR_HSV2BGR)[0, 0].tolist()  # pyright: ignore
    return blue, green, red


def _fixed(points: Array) -> Array:
    """Coordinates in eighths of a pixel."""
    return np.rint(8 * points).astype(np.int32)
