"""Pictures of table tops: drawn from a seed, so that they need no file."""

from functools import lru_cache

import cv2
import numpy as np

from vision_robot.types import Array, Float, UInt8

__all__ = ["belt_picture", "table_picture"]

Colour = tuple[float, float, float]

SIDE = 1024
BELT_PITCH_M = 0.1
"""Length after which the belt's picture repeats."""


@lru_cache(maxsize=8)
def table_picture(surface: str, colour: Colour, seed: int) -> UInt8[Array, "rows columns 3"]:
    """Red-green-blue picture of a table top; its rows run along the grain."""
    rng = np.random.default_rng(seed)
    if surface == "wood":
        shade = _wood(rng)
    elif surface == "speckled":
        shade = _noise(rng, (SIDE, SIDE), 1) * 0.05 + _noise(rng, (SIDE, SIDE), 6) * 0.05
    elif surface == "checked":
        squares = np.indices((16, 16)).sum(axis=0) % 2
        shade = np.kron(squares - 0.5, np.ones((SIDE // 16, SIDE // 16))) * 0.35
    else:
        shade = np.zeros((8, 8))
    picture = _tinted(shade, colour)
    picture.flags.writeable = False  # it is kept
    return picture


def belt_picture(colour: Colour) -> UInt8[Array, "rows columns 3"]:
    """One pitch of a belt: woven rubber with a lighter rib, which shows that it moves."""
    rng = np.random.default_rng(7)
    shade = _noise(rng, (128, 256), 1) * 0.04
    shade[60:66] += 0.12
    return _tinted(shade, colour)


def _wood(rng: np.random.Generator) -> Float[Array, "rows columns"]:
    """Boards with grain: rings stretched along the rows, fine pores, and dark joints."""
    shade = np.zeros((SIDE, SIDE))
    boards = 6
    width = SIDE // boards
    for i in range(boards):
        columns = slice(i * width, SIDE if i == boards - 1 else (i + 1) * width)
        n = shade[:, columns].shape[1]
        bend = _noise(rng, (SIDE, n), (220, 40)) * 2.2
        across = np.linspace(0, 1, n)[None] + rng.uniform(0, 3)
        rings = np.sin(2 * np.pi * (across * rng.uniform(5, 9) + bend))
        shade[:, columns] = 0.045 * rings + rng.uniform(-0.06, 0.06)
        shade[:, columns.start : columns.start + 2] -= 0.18
    return shade + _noise(rng, (SIDE, SIDE), (60, 0.7)) * 0.05 + _noise(rng, (SIDE, SIDE), 0.8) * 0.012


def _noise(
    rng: np.random.Generator, shape: tuple[int, int], blur: float | tuple[float, float]
) -> Float[Array, "rows columns"]:
    """Gaussian noise of unit deviation, blurred by so many rows and columns; repeats at its borders."""
    down, across = blur if isinstance(blur, tuple) else (blur, blur)
    white = rng.standard_normal(shape)
    # A product in frequency: the picture then tiles, and wide blurs cost nothing more.
    v, u = np.fft.fftfreq(shape[0])[:, None], np.fft.rfftfreq(shape[1])[None]
    low = np.exp(-2 * np.pi**2 * ((v * down) ** 2 + (u * across) ** 2))
    soft = np.fft.irfft2(np.fft.rfft2(white) * low, s=shape)
    return soft / soft.std()


def _tinted(shade: Float[Array, "rows columns"], colour: Colour) -> UInt8[Array, "rows columns 3"]:
    """The colour, lightened and darkened by `shade` of itself."""
    tinted = np.array(colour) * (1 + shade[..., None])
    return cv2.convertScaleAbs(np.clip(tinted, 0, 1), alpha=255).reshape(*shade.shape, 3)
