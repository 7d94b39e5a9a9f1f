"""Objects that touch: one blob is parted where those that were apart before would be now."""

import cv2
import numpy as np

from vision_robot.types import Array, Float, Int, UInt8

__all__ = ["parted"]

SHARE = 0.5
"""So much of an object's pixels must be under the blob for it to be in there."""


def parted(
    blob: UInt8[Array, "h w"],
    before: Int[Array, "h w"],
    shifts: dict[int, Float[Array, "2"]],
) -> UInt8[Array, "h w"]:
    """The mask of one blob with a line of one pixel cut between the objects that met in it.

    Args:
        blob: 255 inside, 0 outside.
        before: Numbers of objects in the frame before, 0 for none.
        shifts: How far each of the numbered objects that may be parted has moved since [px].
    """
    away, numbers = [], []
    for number, shift in shifts.items():
        there = np.where(before == number, np.uint8(1), np.uint8(0))
        size = int(there.sum())
        move = np.array([[1, 0, round(float(shift[0]))], [0, 1, round(float(shift[1]))]], dtype=np.float32)
        there = cv2.warpAffine(there, move, (blob.shape[1], blob.shape[0]), flags=cv2.INTER_NEAREST)
        if size and np.count_nonzero(np.bitwise_and(there, blob)) > SHARE * size:
            away.append(cv2.distanceTransform(1 - there, cv2.DIST_L2, 3))
            numbers.append(number)
    if len(numbers) < 2:
        return blob
    owner = np.argmin(np.stack(away), axis=0).astype(np.uint8)
    seam = cv2.dilate(owner, np.ones((2, 2), np.uint8)) != cv2.erode(owner, np.ones((2, 2), np.uint8))
    return np.where(seam, np.uint8(0), blob)
