"""The part of the table that the camera sees."""

from dataclasses import dataclass

import numpy as np

from vision_robot.geometry import plane_from_pixels
from vision_robot.sim.cell_design import StationCamera
from vision_robot.types import Array, Float

__all__ = ["Area"]


@dataclass(frozen=True)
class Area:
    """A part of the picture about its middle, as places on the table."""

    view: StationCamera
    part: float
    """1: the whole picture; more reaches beyond it."""

    def places(self, shares: Float[Array, "n 2"]) -> Float[Array, "n 2"]:
        """Places (x, y) in {S} [m] at shares (across, down) from 0 to 1 of the area.

        The lens is left out: a straight area reaches beyond a curved picture's border without harm.
        """
        camera = self.view.camera.without_distortion()
        middle = (np.array([camera.width, camera.height]) - 1) / 2
        pixels = middle + (np.asarray(shares, dtype=float) - 0.5) * self.part * (camera.width, camera.height)
        return plane_from_pixels(camera, self.view.cam_from_station, pixels)

    def somewhere(self, rng: np.random.Generator, count: int) -> Float[Array, "count 2"]:
        """So many places anywhere in the area."""
        return self.places(rng.random((count, 2)))

    def edge(self, share: float) -> Float[Array, "2"]:
        """A place on the ellipse in the area's border, `share` of the way round."""
        angle = 2 * np.pi * share
        return self.places(0.5 + 0.5 * np.array([[np.cos(angle), np.sin(angle)]]))[0]

    @property
    def reach_m(self) -> float:
        """Distance from the middle to the nearest side of the border."""
        sides = self.places(np.array([[0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]]))
        return float(np.linalg.norm(sides - self.places(np.array([[0.5, 0.5]])), axis=1).min())
