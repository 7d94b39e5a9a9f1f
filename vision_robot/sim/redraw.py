"""Which part of a still camera's picture can differ from the picture of what never moves."""

import numpy as np

from vision_robot.geometry import SE3, Camera
from vision_robot.sim.canvas import Region
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_names import FLOOR_BELOW_M, MOVING
from vision_robot.types import Array, Float

__all__ = ["MovingRegion"]

CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
GRAIN = 32
"""Regions start and end at multiples of so many pixels: buffers then seldom change size."""
PADDING = 2
NEAREST_M = 0.05


class MovingRegion:
    """Finds the rectangle that holds everything that can move, with its shadows.

    Boxes around geoms are enough: their corners are projected, and so are the corners' shadows on table
    and floor; whatever lies between a body and its shadow is inside the hull of both.
    """

    def __init__(self, cell: Cell):
        self._cell, model = cell, cell.model
        self._geoms = np.flatnonzero(model.geom_group == MOVING)
        middle, half = model.geom_aabb[self._geoms, None, :3], model.geom_aabb[self._geoms, None, 3:]
        self._corners = middle + half * CORNERS

    def region(self, camera: Camera, base_from_cam: SE3) -> Region | None:
        """Of the present state; (0, 0, 0, 0) when nothing that moves is seen, None when it cannot be told."""
        if not len(self._geoms):
            return 0, 0, 0, 0
        points = self._points_in_station()
        cam_from_station = base_from_cam.inverse() @ self._cell.base_from_station
        in_cam = cam_from_station.apply(points.reshape(-1, 3)).reshape(points.shape)
        ahead = in_cam[..., 2] > NEAREST_M
        if not ahead.any():
            return 0, 0, 0, 0
        if not ahead[ahead.any(axis=1)].all():
            return None
        pixels = camera.project(in_cam[ahead.all(axis=1)])
        size = (camera.width, camera.height)
        low, high = pixels.min(axis=1) - PADDING, pixels.max(axis=1) + PADDING
        seen = ((high > -0.5) & (low < np.array(size) - 0.5)).all(axis=1)
        if not seen.any():
            return 0, 0, 0, 0
        first = np.maximum(np.floor(low[seen].min(axis=0) / GRAIN) * GRAIN, 0)
        last = np.minimum(np.ceil(high[seen].max(axis=0) / GRAIN) * GRAIN, size)
        (left, top), (width, height) = first.astype(int).tolist(), (last - first).astype(int).tolist()
        return left, top, width, height

    def _points_in_station(self) -> Float[Array, "geoms points 3"]:
        """Corners of the boxes around the geoms and, where there are shadows, of their shadows."""
        cell = self._cell
        R = cell.data.geom_xmat[self._geoms].reshape(-1, 3, 3)
        in_base = self._corners @ np.swapaxes(R, 1, 2) + cell.data.geom_xpos[self._geoms, None]
        points = cell.base_from_station.inverse().apply(in_base.reshape(-1, 3)).reshape(in_base.shape)
        if not cell.design.lights.shadows:
            return points
        sun = cell.model.light("key").id
        towards = -cell.base_from_station.rotation.T @ cell.data.light_xdir[sun]
        on_table = points - towards * (np.maximum(points[..., 2:], 0) / towards[2])
        on_floor = points - towards * (np.maximum(points[..., 2:] + FLOOR_BELOW_M, 0) / towards[2])
        middle, half = np.array(cell.design.table.middle_m), np.array(cell.design.table.size_m) / 2
        past = (np.abs(on_table[..., :2] - middle) > half).any(axis=(1, 2))
        return np.concatenate([points, on_table, np.where(past[:, None, None], on_floor, on_table)], axis=1)
