"""Maximum-likelihood fit of blurred ellipses to a picture.

Each dark disc is modelled as ``I(x) = (offset + gain * Phi(d(x) / blur)) * (1 + slope . q)``,
with q = x - centre, d the distance to the outline (to first order, Sampson 1982), Phi the normal distribution
function and a slope of the light. The ten unknowns of each disc are found by Levenberg-Marquardt on
the grey values, so that under white noise the estimate is efficient and its covariance honest.
The model is symmetric about its centre, whatever the blur: the centre is that of the seen outline's ellipse,
which is not where the disc's centre is seen (see `vision_robot.calibrate.circle_bias`).
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.boards.blobs import EllipseBlobs
from vision_robot.types import Array, Bool, Float, UInt8

__all__ = ["FittedEllipses", "fit_ellipses"]

Grey = UInt8[Array, "height width"]

UNKNOWNS = 10
FIRST_RING_PX, NARROWEST_RING_PX, WIDEST_RING_PX = 8.0, 4.0, 25.0
LEAST_BLUR_PX = 0.25
"""About the blur of the pixel's own area; less cannot be told apart."""

LEAST_SIGMA_PX = 0.002
ITERATIONS = 25


@dataclass(frozen=True)
class FittedEllipses:
    """Table of fits: `centres` (n, 2), their `sigma_px` (n,) per axis, `blur_px` (n,), and which are good."""

    centres: Float[Array, "n 2"]
    sigma_px: Float[Array, "n"]
    blur_px: Float[Array, "n"]
    good: Bool[Array, "n"]


def fit_ellipses(grey: Grey, blobs: EllipseBlobs, *, reach: float) -> FittedEllipses:
    """Fit every blob; `reach` is how far from its centre nothing but the disc is printed, in radii.

    A fit is good when it converged near its start, dark on light, wholly inside the picture.
    """
    n = len(blobs)
    centres, sigma = blobs.centres.copy(), np.full(n, 1.0)
    blur, good = np.full(n, np.nan), np.zeros(n, dtype=bool)
    for k in range(n):
        fit = _fit(grey, blobs.centres[k], blobs.spreads[k], reach)
        if fit is not None:
            centres[k], sigma[k], blur[k] = fit
            good[k] = True
    return FittedEllipses(centres, sigma, blur, good)


def _fit(
    grey: Grey, centre: Float[Array, "2"], spread: Float[Array, "2 2"], reach: float
) -> tuple[Float[Array, "2"], float, float] | None:
    values, vectors = np.linalg.eigh(spread)
    W = vectors @ np.diag(values**-0.5) @ vectors.T
    inside = grey[tuple(np.clip(np.rint(centre[::-1]).astype(int), 0, np.array(grey.shape) - 1))]
    start = np.array([*centre, W[0, 0], W[0, 1], W[1, 1], 1.0, float(inside), 100.0, 0.0, 0.0])
    ring, covariance = FIRST_RING_PX, np.zeros((UNKNOWNS, UNKNOWNS))
    for _ in range(2):
        window = _window(grey, start, ring, reach)
        if window is None:
            return None
        start[6:8] = _levels(*window, start)
        found = _descend(*window, start)
        if found is None:
            return None
        start, covariance = found
        ring = float(np.clip(5 * start[5], NARROWEST_RING_PX, WIDEST_RING_PX))
    largest = np.sqrt(values[1])
    strayed = np.linalg.norm(start[:2] - centre) > max(0.3 * largest, 1.5)
    if strayed or start[7] < 4 or start[5] > largest:
        return None
    sigma = float(np.sqrt(max((covariance[0, 0] + covariance[1, 1]) / 2, LEAST_SIGMA_PX**2)))
    return start[:2], sigma, float(start[5])


def _window(
    grey: Grey, parameters: Float[Array, "10"], ring: float, reach: float
) -> tuple[Float[Array, "2 m"], Float[Array, "m"]] | None:
    """Pixels near the outline and their grey values; None when the disc leaves the picture."""
    W = np.array([[parameters[2], parameters[3]], [parameters[3], parameters[4]]])
    half = np.sqrt(np.diag(np.linalg.inv(W @ W)))
    low, high = parameters[:2] - half, parameters[:2] + half
    size = np.array(grey.shape[::-1])
    if not (np.isfinite(half).all() and (low >= 1).all() and (high <= size - 2).all()):
        return None
    first = np.maximum(np.floor(low - ring), 0).astype(int)
    last = np.minimum(np.ceil(high + ring), size - 1).astype(int)
    u, v = np.meshgrid(np.arange(first[0], last[0] + 1), np.arange(first[1], last[1] + 1))
    pixels = np.stack([u.ravel(), v.ravel()]).astype(float)
    F, distance, _ = _distance(pixels, parameters)
    near = (np.abs(distance) <= ring) & (reach >= F)
    if near.sum() < 2 * UNKNOWNS:
        return None
    u, v = pixels[:, near].astype(int)
    return pixels[:, near], grey[v, u].astype(float)


def _levels(pixels: Float[Array, "2 m"], values: Float[Array, "m"], parameters: Float[Array, "10"]) -> Array:
    """Offset and gain by linear least squares for the given outline."""
    from scipy.special import ndtr

    _, distance, _ = _distance(pixels, parameters)
    edge = ndtr(distance / parameters[5])
    A = np.stack([np.ones_like(edge), edge], axis=1)
    return np.linalg.lstsq(A, values, rcond=None)[0]


def _descend(
    pixels: Float[Array, "2 m"], values: Float[Array, "m"], start: Float[Array, "10"]
) -> tuple[Float[Array, "10"], Float[Array, "10 10"]] | None:
    """Levenberg-Marquardt; the estimate and its covariance, or None when it breaks down."""
    here, damping = start.copy(), 1e-3
    residual, J = _residual(pixels, values, here)
    cost = residual @ residual
    for _ in range(ITERATIONS):
        H, g = J.T @ J, J.T @ residual
        try:
            step = -np.linalg.solve(H + damping * np.diag(np.diag(H) + 1e-12), g)
        except np.linalg.LinAlgError:
            return None
        there = here + step
        there[5] = max(there[5], LEAST_BLUR_PX)
        new_residual, new_J = _residual(pixels, values, there)
        new_cost = new_residual @ new_residual
        if not new_cost <= cost:
            damping *= 10
            if damping > 1e6:
                break
            continue
        small = np.abs(step[:2]).max() < 1e-4 and cost - new_cost < 1e-4 * cost
        here, residual, J, cost, damping = there, new_residual, new_J, new_cost, damping / 10
        if small:
            break
    # Rounding to whole grey values is noise of 1/12 even where the fit is perfect.
    variance = max(cost / (len(values) - UNKNOWNS), 1 / 12)
    try:
        covariance = variance * np.linalg.inv(J.T @ J + 1e-12 * np.eye(UNKNOWNS))
    except np.linalg.LinAlgError:
        return None
    return here, covariance


def _distance(
    pixels: Float[Array, "2 m"], parameters: Float[Array, "10"]
) -> tuple[Float[Array, "m"], Float[Array, "m"], tuple[Array, ...]]:
    """F = |W q| (one on the outline), the distance to the outline [px], and q, W q, W W q, |W W q|."""
    q = pixels - parameters[:2, None]
    W = np.array([[parameters[2], parameters[3]], [parameters[3], parameters[4]]])
    y = W @ q
    z = W @ y
    F = np.maximum(np.hypot(*y), 1e-6)
    N = np.maximum(np.hypot(*z), 1e-12)
    return F, (F - 1) * F / N, (q, y, z, N, W)


def _residual(
    pixels: Float[Array, "2 m"], values: Float[Array, "m"], parameters: Float[Array, "10"]
) -> tuple[Float[Array, "m"], Float[Array, "m 10"]]:
    """Model less picture, and its derivatives."""
    from scipy.special import ndtr

    F, distance, (q, y, z, N, W) = _distance(pixels, parameters)
    blur, offset, gain, slope = parameters[5], parameters[6], parameters[7], parameters[8:10]
    t = distance / blur
    edge = ndtr(t)
    density = np.exp(-0.5 * t * t) / (blur * np.sqrt(2 * np.pi))
    light = 1 + slope @ q
    level = offset + gain * edge
    # d = (F^2 - F) / N, so dd = ((2F - 1) dF - d dN) / N, with dF = y.dy / F and dN = z.dz / N.
    from_F, from_N = (2 * F - 1) / (N * F), distance / (N * N)
    J = np.empty((len(values), UNKNOWNS))
    pull = gain * density * light
    WW = W @ W
    for k in range(2):
        J[:, k] = pull * -(from_F * (W[k] @ y) - from_N * (WW[k] @ z)) - level * slope[k]
    for k, E in enumerate(([[1.0, 0], [0, 0]], [[0.0, 1], [1, 0]], [[0.0, 0], [0, 1]])):
        dy = np.array(E) @ q
        dz = np.array(E) @ y + W @ dy
        J[:, 2 + k] = pull * (from_F * np.sum(y * dy, axis=0) - from_N * np.sum(z * dz, axis=0))
    J[:, 5] = -pull * t
    J[:, 6] = light
    J[:, 7] = edge * light
    J[:, 8:] = (level * q).T
    return level * light - values, J
