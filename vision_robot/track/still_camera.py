"""Does the camera stand still? The picture's shift against its first frame, by phase correlation of tiles."""

import cv2
import numpy as np

from vision_robot.types import Array, Float, Image

__all__ = ["StillCamera"]

WIDTH = 320
"""Frames are compared at about this width."""

TILES = (4, 3)
EVERY = 10
"""Frames between two looks."""

CLEAR = 0.12
"""Response of a tile's correlation below which it tells nothing."""

AGREED = 0.6
"""Share of the clear tiles that must agree."""

NEAR = 0.35
"""How closely tiles agree [px of the reduced picture]."""

MOVED_PX = 1.0
"""Shift from which on the camera counts as moved."""


class StillCamera:
    """Watches the whole picture's shift; objects move in some tiles only, a camera moves all of them."""

    def __init__(self) -> None:
        self._reference: Array | None = None
        self._scale = 1.0
        self._frame = -1
        self._beyond = 0
        self.shift_px = np.zeros(2)
        """The last shift found, (u, v)."""
        self.largest_px = 0.0
        """The largest so far."""
        self.moved_at: int | None = None
        """The frame from which on the camera is known to have moved."""

    def look(self, frame: Image) -> None:
        """The next frame; most are passed over."""
        self._frame += 1
        if self._frame % EVERY:
            return
        small = self._reduced(frame)
        if self._reference is None or self._reference.shape != small.shape:
            self._reference = small
            return
        shift = self._shift(self._reference, small)
        if shift is None:
            return
        self.shift_px = shift * self._scale
        length = float(np.hypot(*self.shift_px))
        self.largest_px = max(self.largest_px, length)
        self._beyond = self._beyond + 1 if length > MOVED_PX else 0
        # Twice in a row: one look may be deceived by what passes.
        if self._beyond >= 2 and self.moved_at is None:
            self.moved_at = self._frame

    def _reduced(self, frame: Image) -> Float[Array, "h w"]:
        grey = frame if frame.ndim == 2 else cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
        self._scale = max(1.0, grey.shape[1] / WIDTH)
        size = (max(16, round(grey.shape[1] / self._scale)), max(16, round(grey.shape[0] / self._scale)))
        return cv2.resize(grey, size, interpolation=cv2.INTER_AREA).astype(np.float32)

    @staticmethod
    def _shift(before: Float[Array, "h w"], after: Float[Array, "h w"]) -> Float[Array, "2"] | None:
        """Shift on which most tiles agree [px], None where they do not."""
        height, width = before.shape
        across, down = width // TILES[0], height // TILES[1]
        window = cv2.createHanningWindow((across, down), cv2.CV_32F)
        shifts = []
        for i in range(TILES[0] * TILES[1]):
            row, column = divmod(i, TILES[0])
            tile = np.s_[row * down : (row + 1) * down, column * across : (column + 1) * across]
            one, other = np.ascontiguousarray(before[tile]), np.ascontiguousarray(after[tile])
            shift, response = cv2.phaseCorrelate(one, other, window)
            if response > CLEAR:
                shifts.append(shift)
        if len(shifts) < 3:
            return None
        middle = np.median(shifts, axis=0)
        agreed = np.linalg.norm(np.array(shifts) - middle, axis=1) < NEAR
        return middle if agreed.mean() >= AGREED else None
