"""How much brighter each channel has become as a whole: lamps, clouds, automatic exposure."""

import numpy as np

from vision_robot.types import Array, Float, Image, UInt8

__all__ = ["channel_gains", "gain_tables"]

SAMPLES = 4000
"""Pixels asked, on a grid over the picture."""

DARK, BRIGHT = 16, 240
"""Outside of these levels a ratio is noise or clipped."""

FEWEST = 50


def channel_gains(frame: Image, reference: Image) -> Float[Array, "3"]:
    """Median ratio of a frame to a reference, per channel; 1 where too few pixels can tell.

    What moves covers less than half of a picture and does not matter.
    """
    skip = max(1, int(np.sqrt(frame.shape[0] * frame.shape[1] / SAMPLES)))
    now = frame[skip // 2 :: skip, skip // 2 :: skip].reshape(-1, 3)
    then = reference[skip // 2 :: skip, skip // 2 :: skip].reshape(-1, 3)
    usable = (then > DARK) & (then < BRIGHT) & (now > DARK) & (now < BRIGHT)
    gains = np.ones(3)
    for channel in range(3):
        told = usable[:, channel]
        if told.sum() >= FEWEST:
            ratio = now[told, channel].astype(np.float32) / then[told, channel]
            gains[channel] = float(np.median(ratio))
    return gains


def gain_tables(gains: Float[Array, "3"]) -> UInt8[Array, "1 256 3"]:
    """Tables for cv2.LUT that multiply each channel by its gain."""
    levels = np.arange(256)[:, None] * np.asarray(gains)[None, :]
    return np.clip(np.rint(levels), 0, 255).astype(np.uint8)[None]
