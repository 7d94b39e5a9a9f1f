"""The pixels around corners that take part in a fit, as one dense table."""

from dataclasses import dataclass

import numpy as np

from vision_robot.types import Array, Float, UInt8

__all__ = ["Windows", "windows"]

TAPER = 0.8
LEAST_PX = 2.5


@dataclass(frozen=True)
class Windows:
    """For each of n corners m pixels: offsets (u, v) from the corner's start, sample, weight (0: padding)."""

    u: Float[Array, "n m"]
    v: Float[Array, "n m"]
    sample: Float[Array, "n m"]
    weight: Float[Array, "n m"]


def windows(
    grey: UInt8[Array, "height width"],
    pixels: Float[Array, "n 2"],
    edges: Float[Array, "n 2 2"],
    *,
    reach: float,
    cap_px: float,
) -> Windows:
    """Elliptic windows that follow the squares: `reach` of the way to the next corners, at most `cap_px`.

    Weights fall smoothly to zero over the last fifth, so that the window's ragged rim does not pull.
    Weights outside the picture are zero.
    """
    height, width = grey.shape
    inverse = np.linalg.inv(edges.transpose(0, 2, 1))
    extent = np.minimum(reach * np.linalg.norm(edges, axis=1).max(), cap_px)
    half = int(np.ceil(max(extent, LEAST_PX))) + 1
    steps = np.arange(-half, half + 1)
    base = np.rint(pixels).astype(int)
    rest = pixels - base
    u = (steps[None, :] - rest[:, :1])[:, None, :]
    v = (steps[None, :] - rest[:, 1:])[:, :, None]
    i = inverse[:, :, :, None, None]
    a, b = i[:, 0, 0] * u + i[:, 0, 1] * v, i[:, 1, 0] * u + i[:, 1, 1] * v
    apart2 = u * u + v * v
    rho2 = np.maximum((a * a + b * b) / reach**2, apart2 / cap_px**2)
    rho = np.sqrt(np.minimum(rho2, apart2 / LEAST_PX**2)).reshape(len(pixels), -1)
    column, row = base[:, :1] + steps, base[:, 1:] + steps
    inside = ((row >= 0) & (row < height))[:, :, None] & ((column >= 0) & (column < width))[:, None, :]
    rho[~inside.reshape(rho.shape)] = 1.0
    most = max(int((rho < 1).sum(axis=1).max()), 1)
    cell = np.argpartition(rho, most - 1, axis=1)[:, :most]
    rho = np.take_along_axis(rho, cell, axis=1)
    fall = np.cos(np.pi / 2 * (rho - TAPER) / (1 - TAPER)) ** 2
    weight = np.where(rho < TAPER, 1.0, np.where(rho < 1, fall, 0.0)).astype(np.float32)
    dv, du = np.divmod(cell, 2 * half + 1)
    du, dv = du - half, dv - half
    samples = grey[np.clip(base[:, 1:] + dv, 0, height - 1), np.clip(base[:, :1] + du, 0, width - 1)].astype(
        np.float32
    )
    return Windows(
        (du - rest[:, :1]).astype(np.float32), (dv - rest[:, 1:]).astype(np.float32), samples, weight
    )
