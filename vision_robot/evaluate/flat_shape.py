"""Measured points beside the figure they should form, wherever it lies."""

from dataclasses import dataclass

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["FlatShape", "flat_shape"]


@dataclass(frozen=True)
class FlatShape:
    """How measured points fit a known figure after the best shift and turn."""

    rms_m: float
    """Root mean square distance, at the figure's own size."""
    scale: float
    """Measured size over true size."""
    mirrored: bool
    """Whether the figure had to be turned over, as a board's is in a {S} with z up."""


def flat_shape(measured: Float[Array, "n 2"], figure: Float[Array, "n 2"]) -> FlatShape:
    """The best rigid fit (Umeyama 1991), turned over where that fits better."""
    fits = [_fit(measured, figure * [1, side]) for side in (1.0, -1.0)]
    best = int(np.argmin([rms for rms, _ in fits]))
    return FlatShape(fits[best][0], fits[best][1], best == 1)


def _fit(measured: Float[Array, "n 2"], figure: Float[Array, "n 2"]) -> tuple[float, float]:
    a, b = measured - measured.mean(axis=0), figure - figure.mean(axis=0)
    U, size, Vt = np.linalg.svd(a.T @ b)
    size = size * [1.0, np.linalg.det(U @ Vt)]
    rotation = U @ np.diag([1.0, np.linalg.det(U @ Vt)]) @ Vt
    rms = float(np.sqrt(np.mean(np.sum((a - b @ rotation.T) ** 2, axis=1))))
    return rms, float(size.sum() / np.sum(b**2))
