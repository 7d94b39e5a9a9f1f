"""Where the descent starts: intrinsics and poses good enough to fall into the right valley.

Zhang's closed form comes first. Weak, distorted or wide-angle views can leave it without
an answer, so other guesses of the focal length are tried beside it, with poses from
bearing vectors, which any lens has; the guess that explains the corners best wins.
"""

from collections.abc import Iterator
from dataclasses import fields, replace

import numpy as np

from vision_robot.calibrate.homography import fit_homographies
from vision_robot.calibrate.normal_equations import residuals
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.settings import Settings
from vision_robot.calibrate.state import State
from vision_robot.calibrate.warp import Warp
from vision_robot.calibrate.zhang import (
    closed_form_intrinsics,
    closed_form_poses,
    closed_form_radial,
    focal_lengths,
)
from vision_robot.errors import DegenerateViews
from vision_robot.geometry import SE3, Camera, lens_named
from vision_robot.types import Array

__all__ = ["poses_from_bearings", "start"]

CORNERS_FOR_START = 24
"""Corners of a board that tell its pose well enough to start from."""

GOOD_START = 0.01
"""Median error, as a part of the picture's width, below which a guess needs no rival."""


def start(seen: Observations, size: tuple[int, int], settings: Settings, warp: Warp) -> State:
    """A camera and the poses of all views; raises DegenerateViews when no guess works."""
    best, best_cost = None, np.inf
    model = settings.model
    closed_forms = _closed_forms(seen, size, model, settings.skew) if model != "fisheye" else ()
    for guesses in (closed_forms, _scanned(size, model)):
        for guess in guesses:
            camera = guess.with_parameters(settings.held(guess.parameters))
            state = State(camera, poses_from_bearings(camera, seen), warp)
            cost = float(np.median(np.abs(residuals(state, seen)[:, 0][seen.present])))
            if cost < best_cost:
                best, best_cost = state, cost
            if best is not None and best_cost < GOOD_START * size[0]:
                return best
    if best is None:
        raise DegenerateViews(("fx", "fy", "cx", "cy"), "no start explains where the corners are")
    return best


def _closed_forms(seen: Observations, size: tuple[int, int], model: str, skew: bool) -> Iterator[Camera]:
    """Zhang's K with and without his radial distortion, and the focal length for a centred picture."""
    width, height = size
    centre = ((width - 1) / 2, (height - 1) / 2)
    n_k = len(lens_named(model).coefficient_names)
    plane, pixels = (a.transpose(0, 2, 1) for a in (seen.points[:, :2], seen.pixels))
    present = seen.present.astype(float)
    H = fit_homographies(plane, pixels, present)
    K = closed_form_intrinsics(H, size, skew=skew)
    if K is not None and _plausible(K, size):
        guess = Camera(width, height, K[0, 0], K[1, 1], K[0, 2], K[1, 2], K[0, 1], model)
        if n_k:
            in_cam = closed_form_poses(K, H).apply(seen.points.transpose(0, 2, 1))
            k1, k2 = closed_form_radial(K, in_cam, pixels, present)
            bent = replace(guess, distortion=(k1, k2, *(0.0,) * (n_k - 2)))
            widest = np.hypot(*(in_cam[..., :2] / in_cam[..., 2:]).transpose(2, 0, 1))[seen.present].max()
            if bent.lens.fold(bent.distortion) > 1.1 * widest:
                yield bent
        yield guess
    focal = focal_lengths(H, centre)
    if focal is not None and 0.1 * width < min(focal) and max(focal) < 50 * width:
        yield Camera(width, height, *focal, *centre, model=model)


def _scanned(size: tuple[int, int], model: str) -> Iterator[Camera]:
    """Focal lengths from the widest to the longest that such a lens has, for a centred picture."""
    width, height = size
    shortest, longest = (0.15, 1.5) if model == "fisheye" else (0.2, 5)
    for focal in np.geomspace(shortest * width, longest * width, 16):
        yield Camera(width, height, focal, focal, (width - 1) / 2, (height - 1) / 2, model=model)


def _plausible(K: Array, size: tuple[int, int]) -> bool:
    """Whether a noisy closed form still looks like a camera."""
    fx, fy, cx, cy = K[0, 0], K[1, 1], K[0, 2], K[1, 2]
    width, height = size
    inside = -0.5 * width < cx < 1.5 * width and -0.5 * height < cy < 1.5 * height
    return bool(0.1 * width < fx < 50 * width and 0.4 < fx / fy < 2.5 and inside)


def poses_from_bearings(camera: Camera, seen: Observations) -> SE3:
    """cam_from_board of each view from rays through its corners.

    Each ray b meets the plane at a positive reach: b x (M (X, Y, 1)) = 0 with
    M = [r1 r2 t], solved linearly for M. Unlike a homography of pixels this holds for
    rays at and beyond 90 degrees from the axis.
    """
    seen = _thinned(seen)
    views, n = seen.ids.shape
    rays = camera.unproject(seen.pixels.transpose(0, 2, 1))
    usable = seen.present & np.isfinite(rays[..., 0])
    rays = np.where(usable[..., None], rays, 0.0)
    total = np.maximum(usable.sum(axis=1), 1)
    plane = seen.points[:, :2].transpose(0, 2, 1)
    centre = np.einsum("vnk,vn->vk", plane, usable) / total[:, None]
    offset = plane - centre[:, None]
    spread = np.sqrt(np.einsum("vnk,vnk,vn->v", offset, offset, usable) / total)
    spread = np.maximum(spread, 1e-12)
    X = np.concatenate([offset / spread[:, None, None], np.ones((views, n, 1))], axis=-1)

    x, y, z = (rays[..., i, None] * X for i in range(3))
    A = np.zeros((views, 3, n, 9))  # rows of b x (M X), M row by row
    A[:, 0, :, 3:6], A[:, 0, :, 6:] = -z, y
    A[:, 1, :, :3], A[:, 1, :, 6:] = z, -x
    A[:, 2, :, :3], A[:, 2, :, 3:6] = -y, x
    A = A.reshape(views, 3 * n, 9)
    normal = A.transpose(0, 2, 1) @ A
    M = np.linalg.eigh(normal)[1][..., 0].reshape(views, 3, 3)
    reach = np.einsum("vni,vni->v", rays, X @ M.transpose(0, 2, 1))
    M = M * np.where(reach < 0, -1.0, 1.0)[:, None, None]
    scale = 2 / np.linalg.norm(M[:, :, :2], axis=1).sum(axis=1)
    M = M * scale[:, None, None]
    r1, r2 = M[..., 0], M[..., 1]
    U, _, Vt = np.linalg.svd(np.stack([r1, r2, np.cross(r1, r2)], axis=-1))
    U[..., 2] *= np.linalg.det(U @ Vt)[:, None]
    rotation = U @ Vt
    origin = M[..., 2] * spread[:, None] - np.einsum("vij,vj->vi", rotation[..., :2], centre)
    return SE3(rotation, origin)


def _thinned(seen: Observations) -> Observations:
    """Some of the corners of whole boards: a start gains nothing from the others."""
    n = seen.ids.shape[1]
    if n <= 2 * CORNERS_FOR_START or not seen.present.all():
        return seen
    some = np.linspace(0, n - 1, CORNERS_FOR_START).astype(int)
    return Observations(*(getattr(seen, field.name)[..., some] for field in fields(seen)))
