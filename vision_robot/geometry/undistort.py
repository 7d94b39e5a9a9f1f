"""Maps that resample a picture from one camera into another."""

from vision_robot.geometry.camera import Camera, pixel_grid
from vision_robot.types import Array, Float

__all__ = ["resampling_map"]


def resampling_map(source: Camera, target: Camera) -> Float[Array, "height width 2"]:
    """For each pixel of `target`, the pixel of `source` that looks along the same ray.

    NaN where `source` does not see. With ``target = source.without_distortion()`` this is
    the undistortion map; with a pinhole `source` and a distorted `target` it renders a lens.
    """
    return source.project(target.unproject(pixel_grid(target.width, target.height)))
