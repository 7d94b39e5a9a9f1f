"""Fitting all corners of one picture.

For every corner, at once, Levenberg-Marquardt fits what the pixels around it show: two edges through
the corner, each with its own direction and blur (so that motion blur is no error), a dark and a
light level that may change across the window. Edges bend as the whole grid says they do.
The fit returns where the corner is, how well that is known, and how blurred the picture is there.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.grid_shape import GridShape, grid_shape
from vision_robot.calibrate.saddle.light import with_smooth_light
from vision_robot.calibrate.saddle.optimum import Optimum, optimum
from vision_robot.calibrate.saddle.problem import SaddleProblem
from vision_robot.calibrate.saddle.sharpness import SharpnessPrior, sharpness_prior
from vision_robot.calibrate.saddle.window import windows
from vision_robot.types import Array, Bool, Float, UInt8

__all__ = ["LOST_PX", "Saddles", "fit_grid", "fit_saddles"]

Grey = UInt8[Array, "height width"]

BLURS_PX = (0.5, 0.8, 1.3, 2.1, 3.4, 5.5)
REACH = 0.75
START_CAP_PX, CAP_PX = 10.0, 20.0
START_DEGREE, DEGREE = 3, 4

START_SETTLED_PX, SETTLED_PX = 0.03, 0.006
"""Last steps of the two passes; convergence is quadratic, so what is left is far smaller."""

CHUNK_PIXELS = 24_000
"""Pixels fitted at once: the Jacobian then stays in the cache (6000 to 100 000 were tried)."""

MODEL_FLOOR_PX = 2e-3
"""What remains on noiseless pictures, from the shape of real blurs and pixels; added to sigma."""

LEAST_CONTRAST = (0.5, 0.15)
"""Half contrast of a corner that counts, in grey levels and in standard deviations of the noise."""

LOST_PX = 2.0
"""Sigma of corners whose fit failed: they keep the detector's position."""


@dataclass(frozen=True)
class Saddles:
    """Fitted corners: `pixels` (n, 2), `covariance` (n, 2, 2) [px²], `blur_px` (n,), `fitted` (n,).

    `blur_px` is the one-sigma width of the blur, the pixel's own extent included. Where `fitted` is false
    the pixel is the start's, its sigma is LOST_PX and its blur NaN.
    """

    pixels: Float[Array, "n 2"]
    covariance: Float[Array, "n 2 2"]
    blur_px: Float[Array, "n"]
    fitted: Bool[Array, "n"]

    @property
    def sigma_px(self) -> Float[Array, "n"]:
        """One standard deviation per axis [px]: the root mean square over directions."""
        return np.sqrt(np.trace(self.covariance, axis1=1, axis2=2) / 2)


def fit_grid(grey: Grey, grid: Float[Array, "rows columns 2"]) -> Saddles:
    """Corners of a full grid, row by row, from starts good to a blur's width or a fifth of a square."""

    def shape(pixels: Float[Array, "n 2"], degree: int) -> GridShape:
        return grid_shape(pixels.reshape(grid.shape), degree=degree)

    return fit_saddles(grey, grid.reshape(-1, 2), shape)


def fit_saddles(
    grey: Grey, pixels: Float[Array, "n 2"], shape: Callable[[Float[Array, "n 2"], int], GridShape]
) -> Saddles:
    """Corners near the starts `pixels`; ``shape(pixels, degree)`` tells how their edges lie.

    Two passes: small windows under even light bring the corners to a few hundredths of a pixel; then come
    full windows with bent edges and uneven light.
    """
    pixels = np.asarray(pixels, dtype=float)
    lie = shape(pixels, START_DEGREE)
    sharpness = _normals(lie.edges) / _start_blur(grey, pixels, lie)
    first = _fit(grey, pixels, lie, sharpness, final=False)
    good = _stayed(first, pixels, pixels, lie)
    near = np.where(good[:, None], pixels + first.theta[:, :2], pixels)

    lie = shape(near, DEGREE)
    if good.any():
        sharpness = _normals(lie.edges) / np.median(first.blur[good])
        sharpness[good] = first.sharpness[good]
    prior = sharpness_prior(first, good, near) if good.any() else None
    second = _fit(grey, near, lie, sharpness, prior, final=True)
    offset, covariance = with_smooth_light(second, near)
    fitted = _stayed(second, near, pixels, lie) & np.isfinite(covariance).all(axis=(1, 2))
    contrast = np.abs(second.theta[:, 9])
    fitted &= contrast > np.maximum(LEAST_CONTRAST[0], LEAST_CONTRAST[1] * np.sqrt(second.variance))
    error = MODEL_FLOOR_PX**2 + _leak(second.blur, lie) ** 2
    covariance = covariance + error[:, None, None] * np.eye(2)
    return Saddles(
        np.where(fitted[:, None], near + offset, pixels),
        np.where(fitted[:, None, None], covariance, LOST_PX**2 * np.eye(2)),
        np.where(fitted, second.blur, np.nan),
        fitted,
    )


def _fit(
    grey: Grey,
    pixels: Float[Array, "n 2"],
    lie: GridShape,
    sharpness: Float[Array, "n 2 2"],
    prior: SharpnessPrior | None = None,
    *,
    final: bool,
) -> Optimum:
    """One pass over all corners, a cache full at a time, windows of like size together."""
    cap_px = CAP_PX if final else START_CAP_PX
    reach = np.minimum(REACH * np.linalg.norm(lie.edges, axis=2), cap_px)
    area = np.pi * reach.prod(axis=1)
    order = np.argsort(-area)
    chunks = min(int(np.ceil(area.sum() / CHUNK_PIXELS)), len(order))
    fits = []
    for some in np.array_split(order, chunks):
        part = lie.take(some)
        window = windows(grey, pixels[some], part.edges, reach=REACH, cap_px=cap_px)
        problem = SaddleProblem.of(window, part, even_light=not final)
        start = problem.with_best_light(_geometry(sharpness[some]))
        settled_px = SETTLED_PX if final else START_SETTLED_PX
        fits.append(optimum(problem, start, settled_px=settled_px, prior=prior and prior.take(some)))
    return Optimum.joined(fits, order)


def _start_blur(grey: Grey, pixels: Float[Array, "n 2"], lie: GridShape) -> float:
    """The one of `BLURS_PX` that explains a dozen corners best."""
    some = np.linspace(0, len(pixels) - 1, min(len(pixels), 12)).astype(int)
    lie = lie.take(some)
    window = windows(grey, pixels[some], lie.edges, reach=REACH, cap_px=START_CAP_PX)
    problem = SaddleProblem.of(window, lie, even_light=True)
    unexplained = []
    for blur in BLURS_PX:
        theta = problem.with_best_light(_geometry(_normals(lie.edges) / blur))
        unexplained.append(float((problem.linearised(theta)[1] ** 2).sum()))
    return BLURS_PX[int(np.argmin(unexplained))]


def _leak(blur: Float[Array, "n"], lie: GridShape) -> Float[Array, "n"]:
    """Error from the next edges where they are blurred into the window [px].

    The share of an edge that the blur carries over the gap, times a third of a square: an estimate,
    set from renders with blurs of a tenth to a quarter of a square.
    """
    square = np.linalg.norm(lie.edges, axis=2).min(axis=1)
    gap = (square - np.minimum(REACH * square, CAP_PX)) / blur
    # A bound on the normal distribution's tail, good enough here.
    return 0.3 * square * np.exp(-0.5 * gap * gap) / (2.5 * gap + 2)


def _geometry(sharpness: Float[Array, "n 2 2"]) -> Float[Array, "n 6"]:
    """Parameters of corners at their starts."""
    return np.concatenate([np.zeros((len(sharpness), 2)), sharpness.reshape(-1, 4)], axis=1)


def _normals(edges: Float[Array, "n 2 2"]) -> Float[Array, "n 2 2"]:
    """Unit normals of edges."""
    along = edges / np.linalg.norm(edges, axis=2, keepdims=True)
    return np.stack([-along[..., 1], along[..., 0]], axis=-1)


def _stayed(
    fit: Optimum, near: Float[Array, "n 2"], start: Float[Array, "n 2"], lie: GridShape
) -> Bool[Array, "n"]:
    """Which fits stayed at their corner, with a blur that the squares can show."""
    square = np.linalg.norm(lie.edges, axis=2).min(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        moved = np.linalg.norm(near + fit.theta[:, :2] - start, axis=1)
        return (moved < 0.3 * square + 0.3) & (fit.blur < 0.6 * square)
