"""Homographies from a plane to its pictures, for many views at once."""

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["apply_homography", "fit_homographies"]


def apply_homography(
    H: Float[Array, "*batch 3 3"], points: Float[Array, "*batch n 2"]
) -> Float[Array, "*batch n 2"]:
    """Map plane positions through homographies; not finite on the horizon."""
    image = points @ np.swapaxes(H[..., :, :2], -1, -2) + H[..., None, :, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        return image[..., :2] / image[..., 2:]


def fit_homographies(
    plane: Float[Array, "views n 2"],
    pixels: Float[Array, "views n 2"],
    weight: Float[Array, "views n"],
    *,
    iterations: int = 8,
) -> Float[Array, "views 3 3"]:
    """Homographies with ``pixels ~ H (X, Y, 1)``, of unit Frobenius norm.

    The normalised direct linear transform (Hartley 1997) starts a Gauss-Newton descent on
    the distance in the image. `weight` is zero where a view lacks a point.
    """
    source, normalise_source = _normalise(plane, weight)
    target, normalise_target = _normalise(pixels, weight)
    H = _direct_linear_transform(source, target, weight)
    for _ in range(iterations):
        try:
            H, step = _gauss_newton_step(H, source, target, weight)
        except np.linalg.LinAlgError:  # corners on a line: the linear answer is as good as any
            break
        if step < 1e-12:
            break
    H = np.linalg.inv(normalise_target) @ H @ normalise_source
    return H / np.linalg.norm(H, axis=(1, 2), keepdims=True)


def _normalise(points: Array, weight: Array) -> tuple[Array, Array]:
    """Shift to the centroid and scale to mean distance sqrt 2; the 3x3 that does it."""
    total = weight.sum(axis=1)[:, None]
    centre = (points * weight[..., None]).sum(axis=1) / total
    offset = points - centre[:, None]
    spread = (np.linalg.norm(offset, axis=-1) * weight).sum(axis=1) / total[:, 0]
    scale = np.sqrt(2) / np.maximum(spread, 1e-300)
    T = np.zeros((len(points), 3, 3))
    T[:, 0, 0] = T[:, 1, 1] = scale
    T[:, :2, 2] = -scale[:, None] * centre
    T[:, 2, 2] = 1
    return offset * scale[:, None, None], T


def _direct_linear_transform(source: Array, target: Array, weight: Array) -> Array:
    homogeneous = np.concatenate([source, np.ones_like(source[..., :1])], axis=-1) * weight[..., None]
    zero = np.zeros_like(homogeneous)
    u, v = target[..., :1], target[..., 1:]
    rows_u = np.concatenate([homogeneous, zero, -u * homogeneous], axis=-1)
    rows_v = np.concatenate([zero, homogeneous, -v * homogeneous], axis=-1)
    A = np.concatenate([rows_u, rows_v], axis=1)
    _, vectors = np.linalg.eigh(np.swapaxes(A, 1, 2) @ A)
    return vectors[..., 0].reshape(-1, 3, 3)


def _gauss_newton_step(H: Array, source: Array, target: Array, weight: Array) -> tuple[Array, float]:
    homogeneous = np.concatenate([source, np.ones_like(source[..., :1])], axis=-1)
    image = homogeneous @ np.swapaxes(H, 1, 2)
    inverse = 1 / image[..., 2:]
    projected = image[..., :2] * inverse
    zero = np.zeros_like(homogeneous)
    scaled = homogeneous * inverse
    J_u = np.concatenate([scaled, zero, -projected[..., :1] * scaled], axis=-1)
    J_v = np.concatenate([zero, scaled, -projected[..., 1:] * scaled], axis=-1)
    J = np.concatenate([J_u, J_v], axis=1) * np.tile(weight, 2)[..., None]
    error = (projected - target) * weight[..., None]
    error = np.concatenate([error[..., 0], error[..., 1]], axis=1)
    # The scale of H is free: pin it by a row along H itself, so that steps are orthogonal to it.
    flat = H.reshape(-1, 9)
    normal = np.swapaxes(J, 1, 2) @ J + flat[:, :, None] * flat[:, None, :]
    step = -np.linalg.solve(normal, np.swapaxes(J, 1, 2) @ error[..., None])[..., 0]
    H = H + step.reshape(-1, 3, 3)
    H = H / np.linalg.norm(H, axis=(1, 2), keepdims=True)
    return H, float(np.abs(step).max())
