"""Where objects part the flow breaks: pixels there are bound to each other less firmly.

A Charbonnier penalty √(ε² + |∇w|²) in place of |∇w|², by weights found from the flow so far.
"""

import cv2
import numpy as np

from vision_robot.types import Array, Float

__all__ = ["bonds"]

LEAST = 0.02
"""Bonds never fall below this, so that flow still spreads where there is nothing to see."""


def bonds(flow: Float[Array, "2 h w"], break_at: float) -> Float[Array, "h w"]:
    """1 where the flow is even, falling where it changes by more than `break_at` px per px."""
    slope = np.zeros(flow.shape[1:], np.float32)
    for plane in flow:
        for along in ((1, 0), (0, 1)):
            change = cv2.Sobel(plane, -1, *along, scale=1 / (8 * break_at), borderType=cv2.BORDER_REPLICATE)
            cv2.accumulateSquare(change, slope)
    return np.maximum(np.reciprocal(cv2.sqrt(slope + 1)), np.float32(LEAST))
