"""What the camera sees where nothing moves: flow says where an object is, the still scene where exactly."""

from collections.abc import Iterable

import cv2
import numpy as np

from vision_robot.types import Array, Image, UInt8

__all__ = ["StillScene"]

SETTLE_S = 1.0
"""Time constant by which the scene takes over what does not move."""

FACTOR, LEAST_LEVELS = 5.0, 4.0
"""Threshold over noise, and the least; for differences smoothed over 3×3 pixels."""

ROLLING = 0.1


class StillScene:
    """A picture that follows the frames wherever no object is."""

    def __init__(self, frame: Image):
        self.image = frame.copy()
        self._mean = frame.astype(np.float32)
        self.noise_levels = np.nan

    @classmethod
    def of(cls, frames: Iterable[Image]) -> "StillScene":
        """The median of some frames: what is behind things that pass."""
        return cls(np.asarray(np.median(np.stack(list(frames)), axis=0), dtype=np.uint8))

    @property
    def threshold_levels(self) -> float:
        """Difference beyond which a pixel does not show the scene."""
        return LEAST_LEVELS if np.isnan(self.noise_levels) else max(LEAST_LEVELS, FACTOR * self.noise_levels)

    def differs(self, frame: Image) -> UInt8[Array, "h w"]:
        """255 where the frame does not show the scene; noise is judged from the frame as a whole."""
        apart = cv2.blur(cv2.absdiff(frame, self.image), (3, 3))
        most = cv2.max(cv2.max(apart[..., 0], apart[..., 1]), apart[..., 2])
        # Means of |noise| over 9 pixels: a change is told from noise by their spread, not by their mean.
        sample = most[1::4, 1::4].astype(np.float32)
        middle = float(np.median(sample))
        noise = middle / 2 + 1.4826 * float(np.median(np.abs(sample - middle)))
        before = self.noise_levels
        self.noise_levels = noise if np.isnan(before) else before + ROLLING * (noise - before)
        return np.where(most > self.threshold_levels + middle, np.uint8(255), np.uint8(0))

    def follow(self, frame: Image, busy: UInt8[Array, "h w"], lapse_s: float) -> None:
        """Take over the frame, slowly, where `busy` is 0."""
        share = float(1 - np.exp(-lapse_s / SETTLE_S))
        cv2.accumulateWeighted(frame, self._mean, share, mask=cv2.bitwise_not(busy))
        self.image = np.asarray(cv2.convertScaleAbs(self._mean), dtype=np.uint8)

    def take(self, frame: Image, where: Array) -> None:
        """Take over the frame at once where told."""
        self._mean[where] = frame[where]
        self.image[where] = frame[where]
