"""How far two cameras disagree about where a ray meets the picture."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera, rotation_exp, rotation_log, skew
from vision_robot.types import Array, Float

__all__ = ["ProjectionError", "fitted_rotation", "projection_difference", "projection_error"]

GRID = (64, 48)
"""Columns and rows of the pixels compared; they reach from the first pixel to the last."""


@dataclass(frozen=True)
class ProjectionError:
    """Size of the difference between two cameras over the whole picture.

    `rms_px` and `max_px` are those of its length, in [0, inf), best 0; `rotation` (3,)
    is the rotation vector [rad] taken out of it, zero where none was; `compared` in
    [0, 1] is the part of the picture where both cameras have a ray.
    """

    rms_px: float
    max_px: float
    rotation: Float[Array, "3"]
    compared: float


def projection_error(camera: Camera, truth: Camera, *, fit_rotation: bool = False) -> ProjectionError:
    """Disagreement of `camera` with `truth` over the whole picture.

    Each pixel q of a regular grid is sent out along its true ray and projected again:
    ``e(q) = camera.project(R truth.unproject(q)) - q``, rms = sqrt(mean |e|^2) and
    max = max |e|. R is the identity (the same ray), or, with `fit_rotation`, the rotation
    of least squares: a camera's intrinsics say nothing about how its frame is turned in
    its housing, and whatever places the camera afterwards takes that turn up (mrcal's
    "implied transformation", Kogan 2021, docs: differencing).

    Raises BadParameter where the pictures differ in size, or no ray is common to both.
    """
    pixels = _grid(truth)
    rotation = fitted_rotation(camera, truth) if fit_rotation else np.zeros(3)
    difference = projection_difference(camera, truth, pixels, rotation=rotation)
    length = np.hypot(difference[..., 0], difference[..., 1])
    known = np.isfinite(length)
    if not known.any():
        raise BadParameter("camera", camera.model, "one that sees some ray of the other camera")
    return ProjectionError(
        rms_px=float(np.sqrt(np.mean(length[known] ** 2))),
        max_px=float(length[known].max()),
        rotation=rotation,
        compared=float(known.mean()),
    )


def projection_difference(
    camera: Camera,
    truth: Camera,
    pixels: Float[Array, "*batch 2"],
    *,
    rotation: Float[Array, "3"] | None = None,
) -> Float[Array, "*batch 2"]:
    """Where `camera` sees the true rays of `pixels`, less those pixels [px]; NaN outside either's field.

    `rotation` [rad] turns the rays from the true camera's frame into the other's.
    """
    if (camera.width, camera.height) != (truth.width, truth.height):
        size = (camera.width, camera.height)
        raise BadParameter("camera size", size, f"that of the truth, {truth.width}x{truth.height}")
    rays = truth.unproject(pixels)
    if rotation is not None:
        rays = rays @ rotation_exp(rotation).T
    return camera.project(rays) - pixels


def fitted_rotation(camera: Camera, truth: Camera) -> Float[Array, "3"]:
    """Rotation vector [rad] of the frame of `camera` against that of `truth`.

    Gauss-Newton on the sum of squares of `projection_difference` over the picture.
    """
    pixels = _grid(truth).reshape(-1, 2)
    rays = truth.unproject(pixels)
    R = np.eye(3)
    for _ in range(20):
        turned = rays @ R.T
        seen, in_point, _ = camera.project_jacobian(turned)
        in_rotation = -in_point @ skew(turned)
        known = np.isfinite(seen).all(axis=1)
        if known.sum() < 2:
            break
        J, error = in_rotation[known].reshape(-1, 3), (seen - pixels)[known].ravel()
        step = np.linalg.lstsq(J, -error, rcond=None)[0]
        R = rotation_exp(step) @ R
        if np.linalg.norm(step) < 1e-13:
            break
    return rotation_log(R)


def _grid(camera: Camera) -> Float[Array, "rows columns 2"]:
    u, v = np.linspace(0, camera.width - 1, GRID[0]), np.linspace(0, camera.height - 1, GRID[1])
    return np.stack(np.meshgrid(u, v), axis=-1)
