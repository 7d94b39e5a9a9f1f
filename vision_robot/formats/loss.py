"""What a format cannot hold is refused or dropped knowingly, never silently."""

from dataclasses import replace

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.formats.camera_format import CameraFormat
from vision_robot.geometry import LENSES, Camera

__all__ = ["fitted", "pixel_shift"]

_RELATED = {"brown8": ("brown8", "brown5"), "brown5": ("brown5", "brown8")}


def fitted(camera: Camera, name: str, target: CameraFormat, *, allow_loss: bool = False) -> Camera:
    """The camera as the format `target`, called `name`, can hold it.

    Numbers without a place there are dropped where `allow_loss`; otherwise raises BadParameter,
    which names them and says how far, at worst, pixels would move. The others are kept as they
    are (no refit), so what is dropped is lost in full. A lens of another kind is always refused.
    """
    related = _RELATED.get(camera.model, (camera.model,))
    model = next((model for model in related if model in target.lenses), None)
    if model is None:
        allowed = f"one of {', '.join(target.lenses)} in the {name} format"
        raise BadParameter("camera model", camera.model, allowed)
    values = dict(zip(camera.lens.coefficient_names, camera.distortion, strict=True))
    kept = target.lenses[model]
    lost = {k: value for k, value in values.items() if value != 0 and k not in kept}
    coefficients = (values.get(k, 0.0) if k in kept else 0.0 for k in LENSES[model].coefficient_names)
    smaller = replace(camera, model=model, distortion=tuple(coefficients))
    if camera.skew != 0 and not target.skew:
        lost["skew"] = camera.skew
        smaller = replace(smaller, skew=0.0)
    if lost and not allow_loss:
        shift = pixel_shift(camera, smaller)
        raise BadParameter(
            f"camera {', '.join(lost)}",
            next(iter(lost.values())) if len(lost) == 1 else tuple(lost.values()),
            f"0 in the {name} format, which has no place for it (dropping it moves pixels by up to "
            f"{shift:.2g} px): write another format, or allow the loss",
        )
    return smaller


def pixel_shift(camera: Camera, other: Camera) -> float:
    """Largest distance [px], over the picture of `camera`, between what both make of one ray."""
    u, v = np.meshgrid(np.linspace(0, camera.width - 1, 25), np.linspace(0, camera.height - 1, 25))
    pixels = np.stack([u, v], axis=-1).reshape(-1, 2)
    with np.errstate(all="ignore"):
        moved = other.project(camera.unproject(pixels)) - pixels
    return float(np.nanmax(np.append(np.hypot(*moved.T), 0.0)))
