"""All corners of all views as one table of arrays, ready for the solver."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.errors import BadParameter
from vision_robot.types import Array, Bool, Float

__all__ = ["Observations"]


@dataclass(frozen=True)
class Observations:
    """Views padded to the same number of corners.

    `points` (views, 3, n) [m, board frame], `pixels` (views, 2, n) and `weight`
    (views, n) = 1/sigma [1/px], zero where a view lacks a corner. `ids` (views, n) are
    board points, -1 in the padding.
    """

    points: Float[Array, "views 3 n"]
    pixels: Float[Array, "views 2 n"]
    weight: Float[Array, "views n"]
    ids: Array
    sigma_px: Float[Array, "views n"]
    """The detector's word, one in the padding."""

    @classmethod
    def of(cls, corners: Sequence[Corners], board_points: Float[Array, "m 3"]) -> "Observations":
        """Gather corners; raises BadParameter where an id names no board point."""
        counts = np.array([len(view) for view in corners], dtype=int)
        views, n = len(corners), int(counts.max(initial=0))
        held = np.arange(n) < counts[:, None]
        points, pixels = np.zeros((views, n, 3)), np.zeros((views, n, 2))
        ids, sigma_px = np.full((views, n), -1), np.ones((views, n))
        if n:
            ids[held] = np.concatenate([view.ids for view in corners])
            pixels[held] = np.concatenate([view.pixels for view in corners])
            sigma_px[held] = np.concatenate([view.sigma_px for view in corners])
        if ids.max(initial=-1) >= len(board_points):
            i = int(np.argmax(ids.max(axis=1)))
            allowed = f"below the board's {len(board_points)} points"
            raise BadParameter(f"corner id in {corners[i].image}", int(ids[i].max()), allowed)
        points[held] = board_points[ids[held]]
        points, pixels = points.transpose(0, 2, 1).copy(), pixels.transpose(0, 2, 1).copy()
        return cls(points, pixels, np.where(held, 1 / sigma_px, 0.0), ids, sigma_px)

    @property
    def present(self) -> Bool[Array, "views n"]:
        """Where a view has a corner."""
        return self.ids >= 0

    @property
    def views(self) -> int:
        """How many views."""
        return len(self.ids)

    def __getitem__(self, views: slice | Array) -> "Observations":
        """Some of the views."""
        return Observations(*(getattr(self, field.name)[views] for field in fields(self)))

    def with_weight(self, weight: Float[Array, "views n"]) -> "Observations":
        """The same corners with other weights."""
        return replace(self, weight=weight)

    def keeping(self, keep: Bool[Array, "views n"]) -> "Observations":
        """The corners under the mask; the others become padding."""
        return replace(self, weight=np.where(keep, self.weight, 0.0), ids=np.where(keep, self.ids, -1))
