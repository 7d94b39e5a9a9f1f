"""Laws of visual servoing for a tool that moves in a plane: pure functions."""

import numpy as np

from vision_robot.geometry import SE3, Camera
from vision_robot.types import Array, Float

__all__ = ["image_step", "interaction_matrix", "position_step"]


def interaction_matrix(x: float, y: float, depth_m: float) -> Float[Array, "2 6"]:
    """How a point at (x, y) of the ideal image plane moves with a twist (v, w) of the *camera*.

    ``[[-1/Z, 0, x/Z, x y, -(1 + x^2), y], [0, -1/Z, y/Z, 1 + y^2, -x y, -x]]``
    (Chaumette & Hutchinson 2006, IEEE RAM 13(4), eq. 11). Where the camera stands and the point moves
    with velocity v instead, its image moves by the first three columns times -v.
    """
    Z = depth_m
    return np.array(
        [
            [-1 / Z, 0.0, x / Z, x * y, -(1 + x * x), y],
            [0.0, -1 / Z, y / Z, 1 + y * y, -x * y, -x],
        ]
    )


def image_step(
    camera: Camera,
    cam_from_station: SE3,
    point_in_station: Float[Array, "3"],
    pixel: Float[Array, "2"],
    wanted_px: Float[Array, "2"],
) -> Float[Array, "2"]:
    """Step of the point in the plane of {S} [m] that brings its image from `pixel` to `wanted_px`.

    Image-based: the error is taken in the ideal image plane, and the interaction matrix, at the depth
    where the point is believed, is inverted for motions along {S}'s x and y.
    """
    rays = camera.unproject(np.stack([pixel, wanted_px]))
    now, wanted = rays[:, :2] / rays[:, 2:]
    depth = float(cam_from_station.apply(point_in_station[None])[0, 2])
    moved = -interaction_matrix(float(now[0]), float(now[1]), depth)[:, :3] @ cam_from_station.rotation[:, :2]
    return np.linalg.solve(moved, wanted - now)


def position_step(seen_m: Float[Array, "2"], wanted_m: Float[Array, "2"]) -> Float[Array, "2"]:
    """Position-based: the step is the error itself, both places seen by the same camera [m]."""
    return wanted_m - seen_m
