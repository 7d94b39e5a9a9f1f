"""Frames with discs and rods whose places are known exactly: every pixel is the mean of 16 x 16 points."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

FINE = 16


@dataclass(frozen=True)
class Shape:
    """A rod of round ends, or a disc where its length is its width; colour blue, green, red."""

    u: float
    v: float
    length: float
    width: float
    yaw: float = 0.0
    colour: tuple[float, float, float] = (40, 40, 200)

    @property
    def area(self) -> float:
        """Of the stadium [px]."""
        return (self.length - self.width) * self.width + np.pi * self.width**2 / 4


def coverage(shape: Shape, size: tuple[int, int]) -> np.ndarray:
    """How much of each pixel the shape covers, (height, width)."""
    width, height = size
    reach = shape.length / 2 + 2
    u0, u1 = int(max(shape.u - reach, 0)), int(min(shape.u + reach + 1, width))
    v0, v1 = int(max(shape.v - reach, 0)), int(min(shape.v + reach + 1, height))
    cover = np.zeros((height, width))
    if u1 <= u0 or v1 <= v0:
        return cover
    fine = (np.arange(FINE) + 0.5) / FINE - 0.5
    u = (np.arange(u0, u1)[:, None] + fine).ravel() - shape.u
    v = (np.arange(v0, v1)[:, None] + fine).ravel() - shape.v
    along = u[None, :] * np.cos(shape.yaw) + v[:, None] * np.sin(shape.yaw)
    across = v[:, None] * np.cos(shape.yaw) - u[None, :] * np.sin(shape.yaw)
    half = (shape.length - shape.width) / 2
    beyond = along - np.clip(along, -half, half)
    inside = beyond**2 + across**2 <= shape.width**2 / 4
    cover[v0:v1, u0:u1] = inside.reshape(v1 - v0, FINE, u1 - u0, FINE).mean(axis=(1, 3))
    return cover


def table(size: tuple[int, int], seed: int = 0, level: float = 150.0) -> np.ndarray:
    """A smooth background of no single colour, (height, width, 3) of floats."""
    import cv2

    rng = np.random.default_rng(seed)
    coarse = rng.uniform(-25, 25, (size[1], size[0], 3))
    smooth = cv2.GaussianBlur(coarse, (0, 0), 9)
    return level + smooth * (20 / max(np.abs(smooth).max(), 1e-9))


def frame_of(
    background: np.ndarray, shapes: Sequence[Shape], *, noise: float = 0.0, seed: int = 0, gain: float = 1.0
) -> np.ndarray:
    """The shapes laid on the background, the lamp at `gain`, with noise of a standard deviation [levels]."""
    picture = background.copy()
    size = (picture.shape[1], picture.shape[0])
    for shape in shapes:
        alpha = coverage(shape, size)[..., None]
        picture = alpha * np.asarray(shape.colour, dtype=float) + (1 - alpha) * picture
    picture = gain * picture
    if noise:
        picture += np.random.default_rng(seed).normal(0, noise, picture.shape)
    return np.clip(np.rint(picture), 0, 255).astype(np.uint8)
