"""How far a change of a camera moves what it sees, over the whole picture.

A camera's own frame is only known through its intrinsics: a change that a turn of that
frame undoes changes nothing that is measured afterwards. So the turn is taken out that
brings the two cameras together best over the picture (mrcal's implied transformation,
Kogan 2021), which at infinity is a rotation.
"""

import numpy as np

from vision_robot.calibrate.projection_uncertainty import picture_grid
from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera, skew
from vision_robot.types import Array, Float

__all__ = ["picture_rays", "rms_px", "shift_between", "shift_per_parameter"]

GRID = (24, 18)


def picture_rays(camera: Camera) -> Float[Array, "n 3"]:
    """Unit rays of n pixels spread over the picture; NaN where the lens model has none."""
    return camera.unproject(picture_grid(camera, *GRID).reshape(-1, 2))


def shift_per_parameter(camera: Camera, rays: Float[Array, "n 3"]) -> Float[Array, "n 2 p"]:
    """Where points at infinity go [px] for a unit change of each of Camera.parameters; NaN where unknown."""
    _, in_rotation, in_parameters = _seen(camera, rays)
    return _without_turn(in_rotation, in_parameters)


def shift_between(camera: Camera, other: Camera, rays: Float[Array, "n 3"]) -> Float[Array, "n 2"]:
    """Where `other` sees points at infinity, less where `camera` does [px]; NaN where either has no ray.

    To first order in the turn between the frames. Raises BadParameter where no ray is
    common to both.
    """
    seen, in_rotation, _ = _seen(other, rays)
    shift = _without_turn(in_rotation, (seen - _seen(camera, rays)[0])[..., None])[..., 0]
    if np.isnan(shift).all():
        raise BadParameter("camera", other.model, "one that sees some ray of the other camera")
    return shift


def rms_px(shift: Float[Array, "*batch n 2"]) -> Float[Array, "*batch"]:
    """Root mean square length of a shift over the picture [px], where it is known."""
    square = np.sum(shift**2, axis=-1)
    known = np.isfinite(square)
    return np.sqrt(np.sum(np.where(known, square, 0.0), axis=-1) / np.maximum(known.sum(axis=-1), 1))


def _seen(camera: Camera, rays: Float[Array, "n 3"]) -> tuple[Array, Array, Array]:
    """Pixels (n, 2) of rays, and their derivatives in a turn (n, 2, 3) and in the parameters (n, 2, p)."""
    known = np.isfinite(rays).all(axis=1)
    rays = np.where(known[:, None], rays, [0.0, 0.0, 1.0])
    seen, in_point, in_parameters = camera.project_jacobian(rays)
    unknown = ~known
    seen[unknown], in_point[unknown], in_parameters[unknown] = np.nan, np.nan, np.nan
    return seen, -in_point @ skew(rays), in_parameters


def _without_turn(in_rotation: Float[Array, "n 2 3"], shift: Float[Array, "n 2 k"]) -> Float[Array, "n 2 k"]:
    """What of a shift no turn explains."""
    known = np.isfinite(in_rotation).all(axis=(1, 2)) & np.isfinite(shift).all(axis=(1, 2))
    P, flat = in_rotation[known].reshape(-1, 3), shift[known].reshape(-1, shift.shape[-1])
    rest = np.full(shift.shape, np.nan)
    rest[known] = (flat - P @ np.linalg.lstsq(P, flat, rcond=None)[0]).reshape(-1, *shift.shape[1:])
    return rest
