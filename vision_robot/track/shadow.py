"""Shadows: pixels that show the background's own colour, darker."""

import numpy as np

from vision_robot.track.runs import Runs
from vision_robot.types import Array, Bool, Image, UInt8

__all__ = ["without_shadows"]

DARKEST, BRIGHTEST = 0.45, 0.97
"""Share of the light left in a shadow; darker is taken for an object, brighter for none."""

LEFT = 0.15
"""A piece keeps its shadow-like pixels unless at least this share of it is something else."""


def without_shadows(
    mask: UInt8[Array, "height width"], frame: Image, background: Image, noise_levels: float
) -> UInt8[Array, "height width"]:
    """The mask less the shadows that objects in it throw.

    A pixel is shadow-like where its colour is the background's times one factor, within the noise. A piece
    that is shadow-like nearly everywhere keeps all its pixels: a grey thing on a grey table looks the same.
    """
    at = np.flatnonzero(mask)
    if not len(at):
        return mask
    like = _shadow_like(frame.reshape(-1, 3)[at], background.reshape(-1, 3)[at], noise_levels)
    if not like.any():
        return mask
    runs = Runs.of_mask(mask)
    label = np.repeat(runs.label, runs.stop - runs.first)  # in the order of the pixels
    share = np.bincount(label, ~like) / np.maximum(np.bincount(label), 1)
    shadowed = mask.copy()
    shadowed.ravel()[at[like & (share[label] >= LEFT)]] = 0
    return shadowed


def _shadow_like(now: UInt8[Array, "k 3"], then: UInt8[Array, "k 3"], noise: float) -> Bool[Array, "k"]:
    x, b = now.astype(np.float32), then.astype(np.float32)
    length = np.einsum("kc,kc->k", b, b)
    factor = np.einsum("kc,kc->k", x, b) / np.maximum(length, 1)
    rest = x - factor[:, None] * b
    allowed = 3 * noise + 0.03 * np.sqrt(length)
    return (factor > DARKEST) & (factor < BRIGHTEST) & (np.einsum("kc,kc->k", rest, rest) < allowed**2)
