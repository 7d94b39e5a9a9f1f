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
        views, n = len(corners), max(map(len, corners), default=0)
        points, pixels = np.zeros((views, 3, n)), np.zeros((views, 2, n))
        weight, ids, sigma_px = np.zeros((views, n)), np.full((views, n), -1), np.ones((views, n))
        for i, view in enumerate(corners):
            if len(view) and view.ids.max() >= len(board_points):
                allowed = f"below the board's {len(board_points)} points"
                raise BadParameter(f"corner id in {view.image}", int(view.ids.max()), allowed)
            m = len(view)
            points[i, :, :m] = board_points[view.ids].T
            pixels[i, :, :m] = view.pixels.T
            weight[i, :m] = 1 / view.sigma_px
            ids[i, :m] = view.ids
            sigma_px[i, :m] = view.sigma_px
        return cls(points, pixels, weight, ids, sigma_px)

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
