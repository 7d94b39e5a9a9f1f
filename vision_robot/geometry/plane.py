"""The work plane: pixels to positions on it, and back.

The plane is Z = 0 of any frame; at work it is the station's, {S}. For a pinhole camera the
map is the homography ``K [r1 r2 t]`` (Zhang 2000, eq. 2), whose inverse ends with a division;
with a lens, rays are met with the plane, which is the same map after removing distortion.
"""

import numpy as np

from vision_robot.geometry.camera import Camera
from vision_robot.geometry.se3 import SE3
from vision_robot.types import Array, Float

__all__ = ["pixels_from_plane", "plane_from_pixels", "plane_homography"]


def plane_homography(K: Float[Array, "3 3"], cam_from_plane: SE3) -> Float[Array, "*batch 3 3"]:
    """Homography ``H ~ K [r1 r2 t]`` from plane positions (X, Y, 1) [m] to undistorted pixels."""
    R, t = cam_from_plane.rotation, cam_from_plane.translation
    return K @ np.stack([R[..., 0], R[..., 1], t], axis=-1)


def plane_from_pixels(
    camera: Camera, cam_from_plane: SE3, pixels: Float[Array, "*batch 2"]
) -> Float[Array, "*batch 2"]:
    """Positions (X, Y) [m] on the plane seen at pixels.

    NaN at and above the horizon, and where no ray leads to the pixel.
    """
    rays = camera.unproject(pixels)
    plane_from_cam = cam_from_plane.inverse()
    direction = rays @ plane_from_cam.rotation.T
    eye = plane_from_cam.translation
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = -eye[2] / direction[..., 2:]
        return np.where(reach > 0, eye[:2] + reach * direction[..., :2], np.nan)


def pixels_from_plane(
    camera: Camera, cam_from_plane: SE3, positions: Float[Array, "*batch 2"]
) -> Float[Array, "*batch 2"]:
    """Pixels of positions (X, Y) [m] on the plane, inside the picture or not.

    NaN where a position lies outside the lens' valid field.
    """
    positions = np.asarray(positions, dtype=float)
    points = np.concatenate([positions, np.zeros((*positions.shape[:-1], 1))], axis=-1)
    return camera.project(cam_from_plane.apply(points.reshape(-1, 3))).reshape(positions.shape)
