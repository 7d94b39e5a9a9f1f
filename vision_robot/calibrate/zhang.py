"""Zhang's closed form: intrinsics, extrinsics and radial distortion from homographies.

Z. Zhang, "A flexible new technique for camera calibration", IEEE PAMI 22(11), 2000.
Equation numbers are those of the paper.
"""

import numpy as np

from vision_robot.geometry import SE3
from vision_robot.types import Array, Float

__all__ = ["closed_form_intrinsics", "closed_form_poses", "closed_form_radial", "focal_lengths"]


def closed_form_intrinsics(
    homographies: Float[Array, "views 3 3"], size: tuple[int, int], *, skew: bool
) -> Float[Array, "3 3"] | None:
    """K from the image of the absolute conic (section 3.1); None where noise leaves none.

    `homographies` map the board plane to pixels of a picture of `size` (width, height).
    Without `skew` the constraint B12 = 0 is added and two views suffice.
    """
    # The picture's centre becomes the origin and its half-diagonal the unit, so that all
    # entries of b have like size.
    width, height = size
    half = np.hypot(width, height) / 2
    to_unit = np.array([[1, 0, -(width - 1) / 2], [0, 1, -(height - 1) / 2], [0, 0, half]]) / half
    H = to_unit @ homographies
    H = H / np.linalg.norm(H, axis=(1, 2), keepdims=True)
    v12, v11, v22 = _conic_row(H, 0, 1), _conic_row(H, 0, 0), _conic_row(H, 1, 1)
    rows = np.concatenate([v12, v11 - v22])  # eq. 8, for all views
    if not skew:
        pin = np.zeros((1, 6))
        pin[0, 1] = np.linalg.norm(rows)
        rows = np.concatenate([rows, pin])
    # Two views give five equations: an empty sixth makes room for the null vector.
    rows = np.concatenate([rows, np.zeros((1, 6))])
    b = np.linalg.svd(rows, full_matrices=False)[2][-1]
    B11, B12, B22, B13, B23, B33 = b if b[0] > 0 else -b
    # Appendix B.
    minor = B11 * B22 - B12 * B12
    if B11 <= 0 or minor <= 0:
        return None
    v0 = (B12 * B13 - B11 * B23) / minor
    scale = B33 - (B13 * B13 + v0 * (B12 * B13 - B11 * B23)) / B11
    if scale <= 0:
        return None
    alpha, beta = np.sqrt(scale / B11), np.sqrt(scale * B11 / minor)
    gamma = -B12 * alpha * alpha * beta / scale
    u0 = gamma * v0 / beta - B13 * alpha * alpha / scale
    K = np.array([[alpha, gamma if skew else 0.0, u0], [0, beta, v0], [0, 0, 1]])
    return np.linalg.inv(to_unit) @ K


def _conic_row(H: Array, i: int, j: int) -> Array:
    """v_ij with v_ij . b = h_i^T B h_j, b = (B11, B12, B22, B13, B23, B33) (eq. 7)."""
    a, b = H[:, :, i], H[:, :, j]
    return np.stack(
        [
            a[:, 0] * b[:, 0],
            a[:, 0] * b[:, 1] + a[:, 1] * b[:, 0],
            a[:, 1] * b[:, 1],
            a[:, 2] * b[:, 0] + a[:, 0] * b[:, 2],
            a[:, 2] * b[:, 1] + a[:, 1] * b[:, 2],
            a[:, 2] * b[:, 2],
        ],
        axis=-1,
    )


def focal_lengths(
    homographies: Float[Array, "views 3 3"], principal_point: tuple[float, float]
) -> tuple[float, float] | None:
    """fx, fy from the same constraints when the principal point is known and there is no skew.

    Linear in 1/fx^2 and 1/fy^2: the start for views too weak or too distorted to carry all of b.
    """
    u0, v0 = principal_point
    H = np.array([[1, 0, -u0], [0, 1, -v0], [0, 0, 1]]) @ homographies
    H = H / np.linalg.norm(H[:, :2], axis=(1, 2), keepdims=True)
    rows = np.concatenate([_conic_row(H, 0, 1), _conic_row(H, 0, 0) - _conic_row(H, 1, 1)])
    A, rhs = rows[:, [0, 2]], -rows[:, 5]
    scale = np.linalg.norm(A, axis=0)
    if not np.all(scale > 0):
        return None
    solution = np.linalg.lstsq(A / scale, rhs, rcond=None)[0] / scale
    if np.all(solution > 0):
        return float(1 / np.sqrt(solution[0])), float(1 / np.sqrt(solution[1]))
    # One focal length for both axes is better determined than two.
    both = A.sum(axis=1)
    single = float(both @ rhs / (both @ both)) if both @ both > 0 else -1.0
    return (1 / np.sqrt(single), 1 / np.sqrt(single)) if single > 0 else None


def closed_form_poses(K: Float[Array, "3 3"], homographies: Float[Array, "views 3 3"]) -> SE3:
    """cam_from_board of each view (section 3.1), the board in front of the camera.

    The nearest rotation (in Frobenius norm, Appendix C) replaces the noisy [r1 r2 r3].
    """
    columns = np.linalg.inv(K) @ homographies
    scale = 2 / np.linalg.norm(columns[:, :, :2], axis=1).sum(axis=1)
    scale = np.where(columns[:, 2, 2] < 0, -scale, scale)
    columns = columns * scale[:, None, None]
    r1, r2, t = columns[..., 0], columns[..., 1], columns[..., 2]
    U, _, Vt = np.linalg.svd(np.stack([r1, r2, np.cross(r1, r2)], axis=-1))
    U[..., 2] *= np.linalg.det(U @ Vt)[:, None]
    return SE3(U @ Vt, t)


def closed_form_radial(
    K: Float[Array, "3 3"],
    points_in_cam: Float[Array, "views n 3"],
    pixels: Float[Array, "views n 2"],
    weight: Float[Array, "views n"],
) -> tuple[float, float]:
    """k1, k2 by linear least squares on the pinhole's residual (eq. 13)."""
    xy = points_in_cam[..., :2] / points_in_cam[..., 2:]
    r2 = (xy * xy).sum(axis=-1)[..., None]
    ideal = xy @ K[:2, :2].T
    residual = pixels - K[:2, 2] - ideal
    w = weight[..., None]
    D = np.stack([(ideal * r2 * w).ravel(), (ideal * r2 * r2 * w).ravel()], axis=-1)
    scale = np.maximum(np.linalg.norm(D, axis=0), 1e-300)
    k1, k2 = np.linalg.lstsq(D / scale, (residual * w).ravel(), rcond=None)[0] / scale
    return float(k1), float(k2)
