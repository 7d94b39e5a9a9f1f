"""The centre of a disc's image is not the image of the disc's centre.

A disc under perspective is seen as an ellipse whose centre lies off the projected centre of the disc
(Heikkilä & Silvén 1997, eq. 8), by an amount that grows with the disc's size and tilt; a lens bends the
outline further. A detector measures the outline's centre; calibration wants the projected centre. Given a
camera and a pose the offset can be computed, and a calibration from uncorrected centres is good enough to
compute it: so calibrate, correct, and calibrate again.
"""

from collections.abc import Callable, Sequence
from typing import Protocol, runtime_checkable

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera, plane_homography
from vision_robot.types import Array, Float

__all__ = ["DiscBoard", "calibrate_circles", "centre_offsets", "corrected_corners"]

OUTLINE_POINTS = 48
"""Points on an outline: the fit of an ellipse to them is exact to 1e-6 px for discs of 60 px."""


@runtime_checkable
class DiscBoard(Protocol):
    """A board whose points are centres of discs."""

    @property
    def points(self) -> Float[Array, "n 3"]:
        """Centres in the board frame [m]."""
        ...

    @property
    def radius_m(self) -> float:
        """Radius of the discs [m]."""
        ...


def centre_offsets(
    camera: Camera, cam_from_board: SE3, centres: Float[Array, "n 3"], radius_m: float
) -> Float[Array, "n 2"]:
    """Centre of the seen outline less projection of the centre, for discs on a board [px].

    `centres` [m] lie in the board's plane z = 0; NaN where the camera does not see a whole outline.
    For a pinhole camera the outline is the projected conic; with a lens it is projected point by point
    and the ellipse of least squared distance is fitted, which is what `fit_ellipses` measures.
    """
    centres = np.asarray(centres, dtype=float)
    seen = camera.project(cam_from_board.apply(centres))
    if camera.model == "pinhole":
        return _conic_centres(camera, cam_from_board, centres, radius_m) - seen
    angle = 2 * np.pi * np.arange(OUTLINE_POINTS) / OUTLINE_POINTS
    circle = radius_m * np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    outlines = camera.project(cam_from_board.apply((centres[:, None] + circle).reshape(-1, 3)))
    return _ellipse_centres(outlines.reshape(len(centres), OUTLINE_POINTS, 2)) - seen


def corrected_corners(
    corners: Sequence[Corners], board: DiscBoard, camera: Camera, cam_from_board: SE3
) -> list[Corners]:
    """Centres of outlines as detected, turned into projections of the discs' centres.

    `cam_from_board` holds one pose for each entry of `corners`. Always correct what the detector
    returned, never what has been corrected before. Points whose outline the camera cannot see stay.
    """
    if len(corners) != len(cam_from_board):
        raise BadParameter("poses", len(cam_from_board), f"as many as views ({len(corners)})")
    corrected = []
    for k, view in enumerate(corners):
        offsets = centre_offsets(camera, cam_from_board[k], board.points[view.ids], board.radius_m)
        pixels = view.pixels - np.nan_to_num(offsets, nan=0.0)
        corrected.append(Corners(view.image, view.ids, pixels, view.sigma_px))
    return corrected


def calibrate_circles(
    corners: Sequence[Corners],
    board: DiscBoard,
    calibrate: Callable[[Sequence[Corners]], CalibrationResult],
    *,
    rounds: int = 3,
    tolerance_px: float = 1e-4,
) -> CalibrationResult:
    """Calibrate from discs: `calibrate`, correct the centres, and again, up to `rounds` corrections.

    `calibrate` is the solver with all its options bound; views it rejects stay uncorrected, and are
    offered to it again. Views are told apart by ``Corners.image``, which must differ. Ends when no centre
    moves by more than `tolerance_px`. Raises BadParameter for two views of one
    name, and whatever `calibrate` raises.
    """
    names = [view.image for view in corners]
    if len(set(names)) != len(names):
        raise BadParameter(
            "names of views", sorted({n for n in names if names.count(n) > 1}), "all different"
        )
    result = calibrate(corners)
    current = list(corners)
    for _ in range(rounds):
        pose = {view.image: k for k, view in enumerate(result.corners)}
        used = [k for k, name in enumerate(names) if name in pose]
        order = np.array([pose[names[k]] for k in used])
        better = corrected_corners(
            [corners[k] for k in used], board, result.camera, result.cam_from_board[order]
        )
        moved = max(
            float(np.abs(b.pixels - current[k].pixels).max()) for k, b in zip(used, better, strict=True)
        )
        if moved < tolerance_px:
            break
        for k, view in zip(used, better, strict=True):
            current[k] = view
        result = calibrate(current)
    return result


def _conic_centres(
    camera: Camera, cam_from_board: SE3, centres: Float[Array, "n 3"], radius_m: float
) -> Float[Array, "n 2"]:
    """Centres of projected discs, from the dual conic ``H C* H^T`` (Hartley & Zisserman 2004, result 8.6)."""
    H = plane_homography(camera.K, cam_from_board)
    x, y = centres[:, 0], centres[:, 1]
    # The dual of the circle (X - x)^2 + (Y - y)^2 = r^2.
    dual = np.empty((len(centres), 3, 3))
    dual[:, :, 2] = dual[:, 2, :] = np.stack([x, y, np.ones_like(x)], axis=1)
    dual[:, 0, 0], dual[:, 1, 1] = x * x - radius_m**2, y * y - radius_m**2
    dual[:, 0, 1] = dual[:, 1, 0] = x * y
    image = H @ dual @ H.T
    return image[:, :2, 2] / image[:, 2:, 2]


def _ellipse_centres(outlines: Float[Array, "n k 2"]) -> Float[Array, "n 2"]:
    """Centres of the ellipses of least squared distance, each stretch of outline by its length.

    Gauss-Newton from the moments of the outline, on the first-order distance to
    ``|W (x - c)| = 1``; W symmetric.
    """
    weight = np.linalg.norm(np.roll(outlines, -1, axis=1) - np.roll(outlines, 1, axis=1), axis=2)
    with np.errstate(invalid="ignore"):
        weight /= weight.sum(axis=1, keepdims=True)
    ok = np.isfinite(weight).all(axis=1) & np.isfinite(outlines).all(axis=(1, 2))
    centres = np.full((len(outlines), 2), np.nan)
    if not ok.any():
        return centres
    points, root = outlines[ok], np.sqrt(weight[ok])
    c = points.mean(axis=1)
    q = points - c[:, None]
    values, vectors = np.linalg.eigh(2 * np.einsum("nki,nkj->nij", q, q) / OUTLINE_POINTS)
    W = np.einsum("nij,nj,nkj->nik", vectors, values**-0.5, vectors)
    for _ in range(8):
        q = points - c[:, None]
        y = np.einsum("nij,nkj->nki", W, q)
        z = np.einsum("nij,nkj->nki", W, y)
        F = np.linalg.norm(y, axis=2)
        slope = np.linalg.norm(z, axis=2) / F
        # dF = y . d(W q) / F
        across = y[..., 0] * q[..., 1] + y[..., 1] * q[..., 0]
        columns = [-z[..., 0], -z[..., 1], y[..., 0] * q[..., 0], across, y[..., 1] * q[..., 1]]
        J = np.stack(columns, axis=-1)
        A = J * (root / (F * slope))[..., None]
        b = root * (F - 1) / slope
        step = -np.linalg.solve(np.einsum("nki,nkj->nij", A, A), np.einsum("nki,nk->ni", A, b)[..., None])[
            ..., 0
        ]
        c = c + step[:, :2]
        W = W + step[:, [2, 3, 3, 4]].reshape(-1, 2, 2)
        if np.abs(step[:, :2]).max() < 1e-9:
            break
    centres[ok] = c
    return centres
