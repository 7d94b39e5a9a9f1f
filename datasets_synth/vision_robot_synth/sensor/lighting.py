"""How much of the light counts, where and when: vignetting, exposure, white balance, flicker, shade.

All of it is one gain for each pixel and channel, a function of place, time and seed.
"""

from functools import lru_cache

import numpy as np

from vision_robot.types import Array, Float
from vision_robot_synth.sensor.chance import Purpose, drift, generator

__all__ = ["channel_gains", "flicker_rows", "shade_field", "vignette"]

SHADE_WIDTH = 0.35
"""Width of the soft edge of a shade, in diagonals of the picture."""


@lru_cache(maxsize=8)
def vignette(size: tuple[int, int], loss: float) -> Float[Array, "height width 3"]:
    """Gain 1 in the middle and ``1 - loss`` in the corners, falling with the fourth power of a cosine.

    The same for all channels; it has them because arrays of one shape multiply four times as fast.
    """
    width, height = size
    u, v = (np.arange(n, dtype=np.float32) - (n - 1) / 2 for n in (width, height))
    square = (u**2 + v[:, None] ** 2) / (u[0] ** 2 + v[0] ** 2)
    # cos^4 of the angle off the axis is 1 / (1 + tan^2)^2, and tan grows with the radius.
    corner = 1 / np.sqrt(1 - loss) - 1
    gain = (1 / (1 + corner * square) ** 2).astype(np.float32)
    return np.repeat(gain[..., None], 3, axis=2)


def channel_gains(
    time_s: float, exposure: float, white_balance: float, period_s: float, seed: int
) -> Float[Array, "3"]:
    """Gains of blue, green and red at a time; the drifts are standard deviations of their logarithms."""
    level = exposure * drift(time_s, period_s, seed, Purpose.EXPOSURE) if exposure else 0.0
    blue = white_balance * drift(time_s, period_s, seed, Purpose.BLUE) if white_balance else 0.0
    red = white_balance * drift(time_s, period_s, seed, Purpose.RED) if white_balance else 0.0
    return np.exp([level + blue, level, level + red]).astype(np.float32)


def flicker_rows(
    time_s: float, rows: int, depth: float, light_hz: float, readout_s: float, seed: int
) -> Float[Array, "rows"]:
    """Gain of each row under a lamp that flickers: a rolling shutter reads the rows one after another."""
    phase = generator(seed, Purpose.FLICKER).uniform(0, 2 * np.pi)
    when = time_s + readout_s * np.arange(rows) / rows
    return (1 + depth * np.sin(2 * np.pi * light_hz * when + phase)).astype(np.float32)


def shade_field(
    time_s: float, size: tuple[int, int], depth: float, period_s: float, seed: int
) -> Float[Array, "height width"]:
    """Gain under a soft shade (a cloud, a person at the window) that comes and goes across the picture."""
    width, height = size
    direction = generator(seed, Purpose.SHADE).uniform(0, 2 * np.pi)
    diagonal = np.hypot(width, height)
    u = (np.arange(width, dtype=np.float32) - (width - 1) / 2) * (np.cos(direction) / diagonal)
    v = (np.arange(height, dtype=np.float32) - (height - 1) / 2) * (np.sin(direction) / diagonal)
    edge = 0.5 * drift(time_s, period_s, seed, Purpose.SHADE, 1)
    # A logistic edge; the field is cheap because exp(a + b) is a product of a row and a column.
    steep = 4 / SHADE_WIDTH
    rise = np.exp(-steep * (u - edge)).astype(np.float32) * np.exp(-steep * v).astype(np.float32)[:, None]
    return np.float32(1) - np.float32(depth) / (1 + rise)
