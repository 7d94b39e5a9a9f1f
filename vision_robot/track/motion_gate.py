"""Where something moves: flow on a picture of moderate size, against what still pixels seem to move."""

import cv2
import numpy as np

from vision_robot.flow import FlowSequence, FlowSettings
from vision_robot.types import Array, Float, Image, UInt8

__all__ = ["MotionGate"]

FULL_HEIGHT = 300
"""Flow is estimated at half the size, and half again, until the height is no more than this."""

FACTOR = 5.0
"""Threshold over the noise of flow: noise alone takes one pixel in a few hundred thousand beyond it."""

LEAST_PX = 0.15
"""No motion below this, per pair of frames: interlacing, lamps and codecs shake pictures that much."""

RAYLEIGH_MEDIAN = 1.1774
"""Median of the length of a vector whose two parts have standard deviation 1."""

ROLLING = 0.1
SHAKES_PX = 0.5
"""Median motion of all pixels beyond which the camera itself is said to move."""


class MotionGate:
    """Flow from the frame `back` frames ago to each new one, and which of it is motion."""

    def __init__(self, shape: tuple[int, ...], back: int, threshold_px: float | None):
        self.halvings = 0
        while (shape[0] >> self.halvings) > FULL_HEIGHT:
            self.halvings += 1
        # From the new frame to the old: the flow then lies where things are now.
        settings = FlowSettings(warps=1, tolerance_px=0.1, median=3)
        self._sequence = FlowSequence(settings, back=back, to_past=True)
        self._fixed = threshold_px
        self.noise_px = np.nan
        self.shift_px = np.zeros(2)
        """Median flow over the picture, rolling."""

    @property
    def threshold_px(self) -> float:
        """Least motion from pair to pair, in the frame's pixels."""
        if self._fixed is not None:
            return self._fixed
        return LEAST_PX if np.isnan(self.noise_px) else max(LEAST_PX, FACTOR * self.noise_px)

    @property
    def camera_moves(self) -> bool:
        """Most of the picture moves alike."""
        return float(np.linalg.norm(self.shift_px)) > SHAKES_PX

    def see(self, frame: Image) -> tuple[Float[Array, "2 h w"], UInt8[Array, "h w"]] | None:
        """Flow [px of the frame] and motion (255, else 0), on the reduced grid; None for the first frames.

        Flow is the motion since the frame compared with, told where things are now.
        """
        grey = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
        for _ in range(self.halvings):
            grey = cv2.resize(grey, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
        result = self._sequence.step(grey)
        if result is None:
            return None
        flow = result.flow * np.float32(-(2**self.halvings))
        self._follow(flow)
        speed = cv2.magnitude(flow[0] - np.float32(self.shift_px[0]), flow[1] - np.float32(self.shift_px[1]))
        return flow, np.where(speed > self.threshold_px, np.uint8(255), np.uint8(0))

    def _follow(self, flow: Float[Array, "2 h w"]) -> None:
        """Roll the noise and the common motion of most pixels."""
        sample = flow[:, ::3, ::3].reshape(2, -1)
        shift = np.median(sample, axis=1)
        noise = float(np.median(np.hypot(*(sample - shift[:, None])))) / RAYLEIGH_MEDIAN
        if np.isnan(self.noise_px):
            self.noise_px, self.shift_px = noise, shift
        else:
            self.noise_px += ROLLING * (noise - self.noise_px)
            self.shift_px = self.shift_px + ROLLING * (shift - self.shift_px)
