"""How an image point moves with what moves: the interaction matrix, and what it is in the plane of {S}."""

import numpy as np

from vision_robot.geometry import WorkPlane
from vision_robot.types import Array, Float

__all__ = ["ideal", "image_step", "interaction_matrix", "plane_matrix"]


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


def plane_matrix(
    plane: WorkPlane, ideal_point: Float[Array, "2"], point_in_station: Float[Array, "3"]
) -> Float[Array, "2 2"]:
    """How the image of a point moves on the ideal plane when the point moves along {S}'s x and y.

    The depth is that of `point_in_station`, where the point is believed to be.
    """
    pose = plane.cam_from_station
    depth = float(pose.apply(point_in_station[None])[0, 2])
    L = interaction_matrix(float(ideal_point[0]), float(ideal_point[1]), depth)
    return -L[:, :3] @ pose.rotation[:, :2]


def ideal(plane: WorkPlane, pixels: Float[Array, "n 2"]) -> Float[Array, "n 2"]:
    """Points (x, y) of the ideal image plane that the lens brings to these pixels."""
    rays = plane.camera.unproject(pixels)
    return rays[:, :2] / rays[:, 2:]


def image_step(
    plane: WorkPlane,
    point_in_station: Float[Array, "3"],
    pixel: Float[Array, "2"],
    wanted_px: Float[Array, "2"],
) -> Float[Array, "2"]:
    """Step of the point in the plane of {S} [m] that brings its image from `pixel` to `wanted_px`.

    Image-based: the error is taken in the ideal image plane, and the mean of the interaction matrices here
    and there is inverted, which errs in the third order of the step (Malis 2004).
    """
    now, wanted = ideal(plane, np.stack([pixel, wanted_px]))
    both = plane_matrix(plane, now, point_in_station) + plane_matrix(plane, wanted, point_in_station)
    return np.linalg.solve(both / 2, wanted - now)
