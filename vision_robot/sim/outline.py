"""The outline of a convex body in a picture, exact: its area, centroid and second moments, and its pixels."""

from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.geometry import Camera
from vision_robot.types import Array, Float, Int

__all__ = ["Moments", "area_moments", "clipped", "outline_of", "row_spans"]

PIECE_PX = 4.0
"""Edges are cut into pieces of this length before a lens bends them."""


@dataclass(frozen=True)
class Moments:
    """Area [px^2], its first moments [px^3] and second moments about the origin (uu, uv, vv) [px^4]."""

    area: float
    first: Float[Array, "2"]
    second: Float[Array, "3"]

    def without(self, u: Float[Array, "n"], v: Float[Array, "n"], side: float = 1.0) -> "Moments":
        """What is left when squares of this side about (u, v) are taken away."""
        # A square adds side^2/12 for each unit of its area to the second moments about its centre.
        n, own, area = len(u), side * side / 12, side * side
        gone = area * np.array([u @ u + n * own, u @ v, v @ v + n * own])
        return Moments(
            self.area - n * area, self.first - area * np.array([u.sum(), v.sum()]), self.second - gone
        )

    @property
    def centroid(self) -> Float[Array, "2"]:
        """Centre of the area."""
        return self.first / self.area

    def axes(self) -> tuple[Float[Array, "2"], float]:
        """Full lengths (major, minor) and direction of the ellipse with the same second moments.

        The direction [rad] is that of the major axis from u towards v, in (-pi/2, pi/2]. The area is one
        of whole squares, not of points at pixel centres: MATLAB's regionprops, too, adds 1/12.
        """
        c = self.centroid
        uu, uv, vv = self.second / self.area - (c[0] * c[0], c[0] * c[1], c[1] * c[1])
        mean, half = (uu + vv) / 2, np.hypot((uu - vv) / 2, uv)
        lengths = 4 * np.sqrt(np.maximum([mean + half, mean - half], 0))
        return lengths, float(np.arctan2(2 * uv, uu - vv) / 2)


def outline_of(points_in_cam: Float[Array, "n 3"], camera: Camera) -> Float[Array, "m 2"] | None:
    """The picture's polygon of the convex hull of points, not cut at the picture's border.

    None where a point lies outside the lens' field: then there is no whole outline.
    """
    # The hull is found in a plane across the line of sight to the body, where straight edges stay
    # straight; any other plane, such as z = 1, would not do for a fisheye that looks behind itself.
    middle = points_in_cam.mean(axis=0)
    to_plane = _facing(middle)
    across = points_in_cam @ to_plane.T
    if across[:, 2].min() <= 1e-6:
        return None
    flat = across[:, :2] / across[:, 2:]
    spread = np.abs(flat).max()
    around = cv2.convexHull((flat / max(spread, 1e-12)).astype(np.float32), returnPoints=False).ravel()
    if camera.model == "pinhole":
        polygon = camera.project(points_in_cam[around])
    else:
        polygon = camera.project(_cut(flat[around], camera) @ to_plane)
    return polygon if np.isfinite(polygon).all() else None


def area_moments(polygon: Float[Array, "m 2"]) -> Moments:
    """Moments of the area inside a polygon (Green's theorem; Steger 1996), whichever way round it goes."""
    if len(polygon) < 3:
        return Moments(0.0, np.zeros(2), np.zeros(3))
    shift = polygon.mean(axis=0)  # about a point nearby: no digits are lost to large coordinates
    x, y = (polygon - shift).T
    x1, y1 = np.append(x[1:], x[0]), np.append(y[1:], y[0])
    cross = x * y1 - x1 * y
    area = cross.sum() / 2
    sign = 1.0 if area >= 0 else -1.0
    first = sign * np.array([((x + x1) * cross).sum(), ((y + y1) * cross).sum()]) / 6
    uu = ((x * x + x * x1 + x1 * x1) * cross).sum() / 12
    vv = ((y * y + y * y1 + y1 * y1) * cross).sum() / 12
    uv = ((2 * x * y + x * y1 + x1 * y + 2 * x1 * y1) * cross).sum() / 24
    area, (sx, sy) = abs(area), shift
    moved = np.array(
        [
            2 * sx * first[0] + area * sx * sx,
            sx * first[1] + sy * first[0] + area * sx * sy,
            2 * sy * first[1] + area * sy * sy,
        ]
    )
    return Moments(area, first + area * shift, sign * np.array([uu, uv, vv]) + moved)


def clipped(polygon: Float[Array, "m 2"], width: int, height: int) -> Float[Array, "k 2"]:
    """The part of a polygon inside a picture, borders of the outer pixels included (Sutherland–Hodgman)."""
    inside = (polygon >= -0.5).all() and (polygon <= (width - 0.5, height - 0.5)).all()
    if inside:
        return polygon
    for axis, limit, sign in ((0, -0.5, 1), (0, width - 0.5, -1), (1, -0.5, 1), (1, height - 0.5, -1)):
        if not len(polygon):
            break
        depth = sign * (polygon[:, axis] - limit)
        kept = []
        for i in range(len(polygon)):
            j = (i + 1) % len(polygon)
            if depth[i] >= 0:
                kept.append(polygon[i])
            if (depth[i] > 0 > depth[j]) or (depth[i] < 0 < depth[j]):
                share = depth[i] / (depth[i] - depth[j])
                kept.append(polygon[i] + share * (polygon[j] - polygon[i]))
        polygon = np.array(kept).reshape(-1, 2)
    return polygon


def row_spans(polygon: Float[Array, "m 2"]) -> tuple[int, Int[Array, "rows"], Int[Array, "rows"]]:
    """First row, and in each row the first and last column whose pixel centre lies in a convex polygon.

    Last is less than first where a row holds none.
    """
    top, bottom = int(np.ceil(polygon[:, 1].min())), int(np.floor(polygon[:, 1].max()))
    rows = np.arange(top, bottom + 1, dtype=float)
    ends = np.roll(polygon, -1, axis=0)
    low, high = np.full(len(rows), np.inf), np.full(len(rows), -np.inf)
    for (u0, v0), (u1, v1) in zip(polygon, ends, strict=True):
        if v0 == v1:
            continue
        first, last = max(int(np.ceil(min(v0, v1))), top), min(int(np.floor(max(v0, v1))), bottom)
        if first > last:
            continue
        part = slice(first - top, last - top + 1)
        u = u0 + (rows[part] - v0) * ((u1 - u0) / (v1 - v0))
        low[part], high[part] = np.minimum(low[part], u), np.maximum(high[part], u)
    empty = ~(high >= low)
    low[empty], high[empty] = 1, 0
    return top, np.ceil(low).astype(int), np.floor(high).astype(int)


def _facing(direction: Float[Array, "3"]) -> Float[Array, "3 3"]:
    """A rotation that carries a direction to z."""
    z = direction / np.sqrt(direction @ direction)
    a, b, c = z.tolist()
    # Across the smaller of the first two; written out, for numpy's cross product takes ten times as long.
    x = np.array([c, 0.0, -a]) if abs(b) < 0.9 else np.array([0.0, -c, b])
    x /= np.sqrt(x @ x)
    p, q, r = x.tolist()
    return np.array([x, [b * r - c * q, c * p - a * r, a * q - b * p], z])


def _cut(flat: Float[Array, "m 2"], camera: Camera) -> Float[Array, "k 3"]:
    """The polygon's corners and points along its edges, on the plane z = 1."""
    focal = max(camera.fx, camera.fy)
    ends = np.roll(flat, -1, axis=0)
    pieces = np.maximum(np.ceil(np.linalg.norm(ends - flat, axis=1) * focal / PIECE_PX), 1).astype(int)
    edge = np.repeat(np.arange(len(flat)), pieces)
    share = np.concatenate([np.arange(n) / n for n in pieces])[:, None]
    points = flat[edge] + share * (ends[edge] - flat[edge])
    return np.concatenate([points, np.ones((len(points), 1))], axis=1)
