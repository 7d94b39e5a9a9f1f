"""What is true of each tracked thing in one picture.

Positions in the picture come from the geometry, not from counted pixels: the outline of a convex body is
the convex hull of its projected corners, and area, centroid and axes of what is seen are integrals over
that polygon, less what is hidden. So they are exact for a thing that nothing hides, where counting pixels
would leave up to a tenth of one. What is hidden is counted, in pixels drawn `FINER` times finer around
the thing, for an occluder need not be convex.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import TypeAlias

import numpy as np

from vision_robot.geometry import SE3, Camera
from vision_robot.sim.canvas import Region
from vision_robot.sim.cell import Cell
from vision_robot.sim.outline import Moments, area_moments, clipped, outline_of, row_spans
from vision_robot.types import Array, Bool, Float, Integer

__all__ = ["FINER", "ObjectTruth", "object_truth"]

FINER = 4
LEAST_AREA_PX = 0.5
"""Less of a thing than this counts as unseen."""

Finer: TypeAlias = Callable[[Region], Integer[Array, "rows columns"]]


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
    bodies: Integer[Array, "height width"],
    hides: Bool[Array, "numbers"],
    finer: Finer | None = None,
) -> ObjectTruth:
    """The truth about the cell's tracked things, seen in a picture with these `bodies`.

    `hides` tells of each number in `bodies` whether it can be in front of a thing; `finer` draws a
    region of `bodies` with `FINER` times as many rows and columns.
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
            _measure(table, i, whole, bodies, _but(hides, int(cell.bodies[i]) + 1), finer)
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
    bodies: Integer[Array, "height width"],
    hides: Bool[Array, "numbers"],
    finer: Finer | None,
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
    seen, box = _less_hidden(seen, box, inside, bodies, hides, finer)
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
    bodies: Integer[Array, "height width"],
    hides: Bool[Array, "numbers"],
    finer: Finer | None,
) -> tuple[Moments, Float[Array, "4"]]:
    """Moments and box of what is left of an outline when what is in front of it is taken away."""
    height, width = bodies.shape
    left, top = np.maximum(np.floor(box[:2]).astype(int), 0).tolist()
    right, bottom = np.minimum(np.ceil(box[:2] + box[2:]).astype(int), (width - 1, height - 1)).tolist()
    others = hides[bodies[top : bottom + 1, left : right + 1]]
    if not others.any() or not (others & _covered(polygon, left, top, others.shape)).any():
        return whole, box
    n = 1
    if finer is not None:
        n = FINER
        others = hides[finer((left, top, right + 1 - left, bottom + 1 - top))]
    covered = _covered(n * (polygon + 0.5) - 0.5, n * left, n * top, others.shape)
    v, u = np.nonzero(others & covered)
    rest = whole.without((u + 0.5) / n - 0.5 + left, (v + 0.5) / n - 0.5 + top, 1 / n)
    v, u = np.nonzero(covered & ~others)
    if not len(u):
        return Moments(0.0, np.zeros(2), np.zeros(3)), box
    # A side whose outermost pixel is seen lies where the outline says; one that is hidden, between pixels.
    low = np.array([u.min(), v.min()]) / n - 0.5 + (left, top)
    high = (np.array([u.max(), v.max()]) + 1) / n - 0.5 + (left, top)
    exact_low, exact_high = box[:2], box[:2] + box[2:]
    low = np.where(np.abs(low - exact_low) < 1 / n, exact_low, low)
    high = np.where(np.abs(high - exact_high) < 1 / n, exact_high, high)
    return rest, np.concatenate([low, high - low])


def _covered(
    polygon: Float[Array, "m 2"], left: int, top: int, shape: tuple[int, int]
) -> Bool[Array, "rows columns"]:
    """Which pixels of a rectangle have their centres in a polygon that reaches out of it by less than one."""
    covered = np.zeros(shape, dtype=bool)
    first, low, high = row_spans(polygon)
    skipped = max(top - first, 0)
    low, high = low[skipped:], high[skipped:]
    rows = covered[first + skipped - top :][: len(low)]
    columns = np.arange(left, left + shape[1])
    low, high = low[: len(rows), None], high[: len(rows), None]
    rows[:] = (columns >= low) & (columns <= high)
    return covered


def _but(hides: Bool[Array, "n"], mine: int) -> Bool[Array, "n"]:
    others = hides.copy()
    others[mine] = False
    return others


def _box(polygon: Float[Array, "m 2"]) -> Float[Array, "4"]:
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    return np.concatenate([low, high - low])
