"""From a blob in the picture to a place and a direction on the table."""

from dataclasses import dataclass

import numpy as np

from vision_robot.geometry import WorkPlane
from vision_robot.types import Array, Float

__all__ = ["Sighting", "Seen", "sighting"]

PIXEL_SIGMA = 0.15
"""Standard deviation of a blob's centroid per axis [px], where the tracker does not say."""


@dataclass(frozen=True)
class Seen:
    """What a tracker says of an object: its centroid, and the direction of its major axis in the picture."""

    centroid_px: Float[Array, "2"]
    yaw_rad: float
    major_px: float


@dataclass(frozen=True)
class Sighting:
    """Where an object lies in {S}: position [m] with covariance [m^2], direction of its axis [rad]."""

    position_m: Float[Array, "2"]
    covariance_m2: Float[Array, "2 2"]
    yaw_rad: float
    height_m: float
    """Of the object's axis over the table, known from its size."""


def sighting(plane: WorkPlane, seen: Seen, height_m: float) -> Sighting:
    """Meet the rays of the centroid and of two points along the axis with the plane at `height_m`.

    `height_m` is that of the object's axis: half its thickness for a rod. NaN where a ray misses the plane.
    """
    along = 0.25 * seen.major_px * np.array([np.cos(seen.yaw_rad), np.sin(seen.yaw_rad)])
    pixels = seen.centroid_px + np.array([np.zeros(2), along, -along])
    positions, covariance = plane.measure(pixels, PIXEL_SIGMA, z_m=height_m)
    ahead = positions[1] - positions[2]
    return Sighting(positions[0], covariance[0], float(np.arctan2(ahead[1], ahead[0])), height_m)
