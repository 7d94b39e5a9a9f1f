"""From a blob in the picture to a place and a direction on the table."""

from dataclasses import dataclass, field, replace

import numpy as np

from vision_robot.geometry import SE3, WorkPlane
from vision_robot.sim.outline import Moments, area_moments, outline_of
from vision_robot.types import Array, Float

__all__ = ["Seen", "Sighting", "as_middle", "expected_axes_px", "sighting"]

PIXEL_SIGMA = 0.15
"""Standard deviation of a blob's centroid per axis [px], where the tracker does not say."""

ROUNDS = 3
"""Of fitting the outline; each leaves less than a hundredth of the error before it."""


@dataclass(frozen=True)
class Seen:
    """What a tracker says of an object: its centroid, and the direction of its major axis in the picture."""

    centroid_px: Float[Array, "2"]
    yaw_rad: float
    major_px: float
    minor_px: float = 0.0
    hull: Float[Array, "n 3"] | None = field(default=None, compare=False)
    """Corners of the body behind the blob, about its middle, x along its length [m].

    None where the pixel is that of the middle itself.
    """


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

    `height_m` is that of the object's middle: half its thickness. NaN where a ray misses the plane. The
    centroid of an outline is not the image of the middle: what is nearer looks larger, and sides are seen
    besides tops. Where the body's hull is known, the place is found at which it looks as it was seen.
    """
    return _met(plane, as_middle(plane, seen, height_m), height_m)


def as_middle(plane: WorkPlane, seen: Seen, height_m: float) -> Seen:
    """The pixel of the body's middle and the direction of its axis, from those of its outline."""
    if seen.hull is None:
        return seen
    middle = replace(seen, hull=None)
    for _ in range(ROUNDS):
        offset = _outline_offset(plane, _met(plane, middle, height_m), seen.hull)
        if offset is None:
            break
        middle = replace(
            middle, centroid_px=seen.centroid_px - offset[:2], yaw_rad=float(seen.yaw_rad - offset[2])
        )
    return middle


def expected_axes_px(plane: WorkPlane, seen: Seen, height_m: float) -> Float[Array, "2"]:
    """Axes that the outline of the seen body would have there (major, minor); NaN where it is not whole."""
    assert seen.hull is not None
    moments = _outline(plane, _met(plane, seen, height_m), seen.hull)
    return np.full(2, np.nan) if moments is None else moments.axes()[0]


def _met(plane: WorkPlane, seen: Seen, height_m: float) -> Sighting:
    yaw = seen.yaw_rad if np.isfinite(seen.yaw_rad) else 0.0  # a round blob has none, and needs none
    along = 0.25 * seen.major_px * np.array([np.cos(yaw), np.sin(yaw)])
    pixels = seen.centroid_px + np.array([np.zeros(2), along, -along])
    positions, covariance = plane.measure(pixels, PIXEL_SIGMA, z_m=height_m)
    ahead = positions[1] - positions[2]
    return Sighting(positions[0], covariance[0], float(np.arctan2(ahead[1], ahead[0])), height_m)


def _outline(plane: WorkPlane, found: Sighting, hull: Float[Array, "n 3"]) -> Moments | None:
    polygon = outline_of(_cam_from_body(plane, found).apply(hull), plane.camera)
    return None if polygon is None else area_moments(polygon)


def _cam_from_body(plane: WorkPlane, found: Sighting) -> SE3:
    position = np.array([*found.position_m, found.height_m])
    return plane.cam_from_station @ SE3.from_rotvec(np.array([0.0, 0.0, found.yaw_rad]), position)


def _outline_offset(plane: WorkPlane, found: Sighting, hull: Float[Array, "n 3"]) -> Float[Array, "3"] | None:
    """How far centroid [px] and direction [rad] of the outline are off the images of middle and axis."""
    step = 0.25 * float(np.ptp(hull[:, 0]))
    on_axis = np.array([[0.0, 0, 0], [step, 0, 0], [-step, 0, 0]])
    axis = plane.camera.project(_cam_from_body(plane, found).apply(on_axis))
    moments = _outline(plane, found, hull)
    if moments is None or not np.isfinite(axis).all():
        return None  # part of it lies outside the lens' field
    ahead = axis[1] - axis[2]
    turn = moments.axes()[1] - np.arctan2(ahead[1], ahead[0])
    return np.array([*(moments.centroid - axis[0]), (turn + np.pi / 2) % np.pi - np.pi / 2])
