"""Which way round a hand has its label in sight: by the lines of sight past the arm's own skeleton."""

from itertools import pairwise

import numpy as np

from vision_robot.geometry import SE3, SerialChain, WorkPlane
from vision_robot.types import Array, Float

__all__ = ["clearance_m", "skeleton"]

PIECES = np.linspace(0, 1, 25)[:, None]


def skeleton(chain: SerialChain, joints: Float[Array, "n"]) -> Float[Array, "k 3"]:
    """Points in {B} along straight lines from joint to joint and on to the wrist."""
    frames = [*chain.base_from_joints(joints), chain.base_from_wrist(joints)]
    places = np.stack([np.zeros(3), *(frame.translation for frame in frames)])
    return np.concatenate([a + PIECES * (b - a) for a, b in pairwise(places)])


def clearance_m(
    plane: WorkPlane,
    skeleton_in_station: Float[Array, "k 3"],
    corners_in_station: Float[Array, "n 3"],
) -> float:
    """Least distance [m] at which a line of sight to a corner passes the skeleton or the picture's border.

    How thick the links are is not asked: of two ways round the one with more room is the better.
    """
    station_from_cam: SE3 = plane.cam_from_station.inverse()
    eye = station_from_cam.translation
    sight = corners_in_station - eye  # (n, 3)
    share = np.clip((skeleton_in_station - eye) @ sight.T / np.sum(sight**2, axis=1), 0, 1)  # (k, n)
    nearest = eye + share[:, :, None] * sight
    past_arm = float(np.linalg.norm(skeleton_in_station[:, None] - nearest, axis=2).min())
    pixels = plane.camera.project(plane.cam_from_station.apply(corners_in_station))
    if not np.isfinite(pixels).all():
        return -np.inf
    camera = plane.camera
    room_px = float(np.minimum(pixels, [camera.width - 1, camera.height - 1] - pixels).min())
    return min(past_arm, room_px * float(np.linalg.norm(sight, axis=1).mean()) / max(camera.fx, camera.fy))
