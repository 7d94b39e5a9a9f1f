"""Holding the light in each window to what the whole picture says about it."""

import numpy as np

from vision_robot.calibrate.saddle.optimum import Optimum
from vision_robot.types import Array, Float

__all__ = ["smooth_surface", "with_smooth_light"]

SLOPES = np.array([7, 8, 10, 11])
"""Of the twelve parameters, the slopes of level and contrast."""

MEDIAN_CHI2 = 0.455
"""Median of a squared standard normal."""

LEAST_SCATTER = 0.02


def with_smooth_light(
    fit: Optimum, pixels: Float[Array, "n 2"]
) -> tuple[Float[Array, "n 2"], Float[Array, "n 2 2"]]:
    """Offsets of the corners [px] and their covariances [px²] under light that is smooth over the board.

    In one window, a slope of the light and a move of the corner look much alike. All windows together know
    the light far better: slopes are drawn towards a quadratic surface through all of them, as firmly as they
    follow it beyond their own noise (empirical Bayes; Efron and Morris 1973), in one linear step.
    """
    # To grey levels per pixel, so that windows of different size can be compared.
    scale = np.ones_like(fit.theta)
    scale[:, SLOPES] = fit.radius[:, None]
    outer = scale[:, :, None] * scale[:, None, :]
    theta, normal = fit.theta / scale, fit.normal * outer
    n, p = theta.shape
    variance = fit.variance[:, None]
    diagonal = np.einsum("nii->ni", normal)
    # The sums were made in single precision: lift them above what that may have made indefinite.
    normal = normal + (1e-6 * diagonal + 1e-12)[:, :, None] * np.eye(p)
    seen = theta[:, SLOPES]
    noise = np.einsum("nii->ni", np.linalg.inv(normal))[:, SLOPES] * variance
    expected = smooth_surface(pixels, seen, noise)
    typical = np.median(noise, axis=0)
    scatter = np.median((seen - expected) ** 2 - MEDIAN_CHI2 * noise, axis=0) / MEDIAN_CHI2
    prior = np.zeros((n, p))
    prior[:, SLOPES] = variance / np.maximum(scatter, LEAST_SCATTER * typical).clip(1e-12)
    firm = prior[:, :, None] * np.eye(p)
    held = np.linalg.inv(normal + firm)
    pull = prior[:, SLOPES] * (expected - seen)
    offset = theta[:, :2] + np.einsum("nij,nj->ni", held[:, :2, SLOPES], pull)
    # Weights at the rim make this an upper bound, by some percent.
    return offset, held[:, :2, :2] * variance[:, :, None]


def smooth_surface(
    pixels: Float[Array, "n 2"], values: Float[Array, "n k"], noise: Float[Array, "n k"]
) -> Float[Array, "n k"]:
    """Values of a quadratic surface weighted by `noise`; a plane or a constant where corners are few."""
    n = len(pixels)
    centred = pixels - pixels.mean(axis=0)
    x, y = (centred / np.abs(centred).max().clip(1)).T
    terms = 6 if n >= 24 else 3 if n >= 9 else 1
    surface = np.stack([np.ones(n), x, y, x * x, x * y, y * y], axis=1)[:, :terms]
    root = 1 / np.sqrt(noise + np.median(noise, axis=0))
    fits = [
        surface @ np.linalg.lstsq(surface * w[:, None], v * w, rcond=None)[0]
        for v, w in zip(values.T, root.T, strict=True)
    ]
    return np.stack(fits, axis=1)
