"""Ghosts: places where the background model holds something that has gone."""

import cv2
import numpy as np

from vision_robot.track.blobs import Blobs
from vision_robot.types import Array, Bool, Image, UInt8

__all__ = ["are_ghosts"]

TIMES = 1.5
"""The model must show its edge so many times as strong as the frame does."""


def are_ghosts(
    blobs: Blobs, mask: UInt8[Array, "height width"], frame: Image, background: Image
) -> Bool[Array, "n"]:
    """Which blobs are outlined in the background model instead of in the frame."""
    found = np.zeros(len(blobs), dtype=bool)
    height, width = mask.shape
    for i, (left, top, wide, high) in enumerate(blobs.box_px):
        u, v = max(int(left) - 3, 0), max(int(top) - 3, 0)
        part = np.s_[v : min(int(top + high) + 5, height), u : min(int(left + wide) + 5, width)]
        inside = mask[part]
        square = np.ones((3, 3), np.uint8)
        border = cv2.dilate(inside, square) != cv2.erode(inside, square)
        if border.any():
            found[i] = _edge(background[part], border) > TIMES * _edge(frame[part], border) + 1
    return found


def _edge(image: Image, border: Array) -> float:
    """Mean strength of edges along the border [levels]."""
    grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    across, down = cv2.Sobel(grey, cv2.CV_32F, 1, 0), cv2.Sobel(grey, cv2.CV_32F, 0, 1)
    return float(np.hypot(across, down)[border].mean() / 8)
