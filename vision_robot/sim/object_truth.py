"""What is true of each tracked thing in one picture.

Positions in the picture come from the geometry, not from counted pixels: the outline of a convex body is
the convex hull of its projected corners, and area, centroid and axes of what is seen are integrals over
that polygon, less the pixels in which something else is in front. So they are exact for a thing that
nothing hides (counting pixels would leave some hundredths of a pixel), and off by no more than the hidden
border's rounding to pixels where something does.
"""

from dataclasses import dataclass, fields

import numpy as np

from vision_robot.geometry import SE3, Camera
from vision_robot.sim.cell import Cell
from vision_robot.sim.outline import Moments, area_moments, clipped, outline_of, row_spans
from vision_robot.types import Array, Bool, Float, Int

__all__ = ["ObjectTruth", "object_truth"]

LEAST_AREA_PX = 0.5
"""Less of a thing than this counts as unseen."""


@dataclass(frozen=True)
class ObjectTruth:
    """One row for each tracked thing, in the order of `Cell.tracked`; NaN where it is not seen.

    Boxes are (left, top, width, height) of the outline itself, so left = -0.5 is the picture's border.
    """

    names: tuple[str, ...]
    station_from_object: SE3
    velocity: Float[Array, "n 6"]
    """Of the thing's middle [m/s], then angular [rad/s], in axes of {S}."""
    has_yaw: Bool[Array, "n"]
    centroid_px: Float[Array, "n 2"]
    """Of the part that is seen."""
    centre_px: Float[Array, "n 2"]
    """The picture of the thing's middle, hidden or not; it is not the centroid of its outline, which
    perspective shifts towards the nearer side."""
    amodal_centroid_px: Float[Array, "n 2"]
    """Of the whole outline, hidden parts and parts outside the picture included."""
    amodal_box_px: Float[Array, "n 4"]
    visible_box_px: Float[Array, "n 4"]
    amodal_area_px: Float[Array, "n"]
    area_px: Float[Array, "n"]
    axes_px: Float[Array, "n 2"]
    """Full lengths (major, minor) of the ellipse with the second moments of the part that is seen."""
    orientation_rad: Float[Array, "n"]
    """Direction of the major axis in the picture, from u towards v, in (-pi/2, pi/2]."""
    occluded: Float[Array, "n"]
    """Share of the whole outline that is not seen, hidden or outside the picture."""
    truncated: Float[Array, "n"]
    """Share of the whole outline outside the picture."""

    def __len__(self) -> int:
        return len(self.names)


def object_truth(
    cell: Cell,
    camera: Camera,
    cam_from_object: SE3,
    bodies: Int[Array, "height width"],
    hides: Bool[Array, "bodies+1"],
) -> ObjectTruth:
    """The truth about the cell's tracked things, seen in a picture with these `bodies`.

    `hides` tells of each number in `bodies` whether it can be in front of a thing.
    """
    n = len(cell.tracked)
    table = {
        one.name: np.full((n, *SHAPES[one.name]), np.nan) for one in fields(ObjectTruth) if one.name in SHAPES
    }
    table["occluded"][:] = table["truncated"][:] = 1.0
    table["area_px"][:] = 0.0
    table["centre_px"][:] = camera.project(cam_from_object.translation)
    for i in range(n):
        whole = outline_of(cam_from_object[i].apply(cell.hulls[i]), camera)
        if whole is not None:
            _measure(table, i, whole, bodies, _but(hides, int(cell.bodies[i]) + 1))
    return ObjectTruth(
        names=cell.tracked,
        station_from_object=cell.station_from_tracked(),
        velocity=np.array([cell.velocity(name) for name in cell.tracked]).reshape(n, 6),
        has_yaw=cell.has_yaw,
        **table,
    )


SHAPES: dict[str, tuple[int, ...]] = {
    "centroid_px": (2,),
    "centre_px": (2,),
    "amodal_centroid_px": (2,),
    "amodal_box_px": (4,),
    "visible_box_px": (4,),
    "amodal_area_px": (),
    "area_px": (),
    "axes_px": (2,),
    "orientation_rad": (),
    "occluded": (),
    "truncated": (),
}


def _measure(
    table: dict[str, Array],
    i: int,
    whole: Float[Array, "m 2"],
    bodies: Int[Array, "height width"],
    hides: Bool[Array, "bodies+1"],
) -> None:
    """Fill row i of the table from the outline."""
    height, width = bodies.shape
    amodal = area_moments(whole)
    table["amodal_box_px"][i], table["amodal_area_px"][i] = _box(whole), amodal.area
    if amodal.area <= 0:
        return
    table["amodal_centroid_px"][i] = amodal.centroid
    inside = clipped(whole, width, height)
    seen = amodal if inside is whole else area_moments(inside)
    table["truncated"][i] = 1 - seen.area / amodal.area
    if seen.area < LEAST_AREA_PX:
        return
    box = _box(inside)
    seen, box = _less_hidden(seen, box, inside, bodies, hides)
    if seen.area < LEAST_AREA_PX:
        return
    table["area_px"][i], table["centroid_px"][i] = seen.area, seen.centroid
    table["axes_px"][i], table["orientation_rad"][i] = seen.axes()
    table["visible_box_px"][i] = box
    table["occluded"][i] = 1 - seen.area / amodal.area


def _less_hidden(
    whole: Moments,
    box: Float[Array, "4"],
    polygon: Float[Array, "m 2"],
    bodies: Int[Array, "height width"],
    hides: Bool[Array, "bodies+1"],
) -> tuple[Moments, Float[Array, "4"]]:
    """Moments and box of what is left when the pixels with something else in front are taken away."""
    height, width = bodies.shape
    left, top = np.maximum(np.floor(box[:2]).astype(int), 0)
    right, bottom = np.minimum(np.ceil(box[:2] + box[2:]).astype(int), (width - 1, height - 1))
    others = hides[bodies[top : bottom + 1, left : right + 1]]
    if not others.any():
        return whole, box
    first_row, low, high = row_spans(polygon)
    rows = slice(max(first_row - top, 0), first_row + len(low) - top)
    low, high = low[max(top - first_row, 0) :], high[max(top - first_row, 0) :]
    columns = np.arange(left, right + 1)
    covered = np.zeros_like(others)
    covered[rows] = ((columns >= low[:, None]) & (columns <= high[:, None]))[: covered[rows].shape[0]]
    v, u = np.nonzero(others & covered)
    if not len(u):
        return whole, box
    rest = whole.without(u + left, v + top)
    v, u = np.nonzero(covered & ~others)
    if not len(u):
        return Moments(0.0, np.zeros(2), np.zeros(3)), box
    # A side whose outermost pixel is seen lies where the outline says; one that is hidden, between pixels.
    border = np.array([u.min() + left - 0.5, v.min() + top - 0.5, u.max() + left + 0.5, v.max() + top + 0.5])
    exact = np.concatenate([box[:2], box[:2] + box[2:]])
    border = np.where(np.abs(border - exact) < 1, exact, border)
    return rest, np.concatenate([border[:2], border[2:] - border[:2]])


def _but(hides: Bool[Array, "n"], mine: int) -> Bool[Array, "n"]:
    others = hides.copy()
    others[mine] = False
    return others


def _box(polygon: Float[Array, "m 2"]) -> Float[Array, "4"]:
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    return np.concatenate([low, high - low])
