"""Tracks in millimetres: position, heading and speed on the work plane, with their sigma."""

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry.work_plane import WorkPlane
from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float

__all__ = ["OnPlane"]

STEP_PX = 1.0
"""Half the length over which a direction in the picture is carried to the plane."""


class OnPlane:
    """Carries rows to the plane, frame by frame; yaws go on past half a turn there too."""

    def __init__(self, plane: WorkPlane, size: tuple[int, int], *, z_m: float = 0.0):
        """`size` is (width, height) of the frames, `z_m` the height of what is tracked over the plane.

        Raises BadParameter for a camera of another size, or one that does not see the plane.
        """
        camera = plane.camera
        if (camera.width, camera.height) != size:
            allowed = f"{camera.width}x{camera.height} px, the calibrated camera's"
            raise BadParameter("size of the frames", f"{size[0]}x{size[1]} px", allowed)
        across, down = np.linspace(0, size[0] - 1, 7), np.linspace(0, size[1] - 1, 7)
        grid = np.stack(np.meshgrid(across, down), axis=-1).reshape(-1, 2)
        seen, _ = plane.measure(grid, z_m=z_m)
        if not np.isfinite(seen).any():
            raise BadParameter(
                "work plane", "behind the camera or beyond its horizon", "in the camera's view"
            )
        self._plane, self._z_m = plane, z_m
        self._yaw: dict[int, float] = {}

    def carry(self, tracks: Tracks) -> Tracks:
        """The rows with `position_m`, `velocity_m_s` and yaw in the plane; yaw is then measured there."""
        if not len(tracks):
            return tracks
        sigma = tracks.extra.get("sigma_px", np.zeros(len(tracks)))
        position, covariance = self._plane.measure(tracks.centroid_px, sigma, z_m=self._z_m)
        along = np.stack([np.cos(tracks.yaw_rad), np.sin(tracks.yaw_rad)], axis=1)
        axis = self._carried(tracks.centroid_px, along)
        rate = np.stack([tracks.extra["vu_px_s"], tracks.extra["vv_px_s"]], axis=1)
        speed_px = np.linalg.norm(rate, axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            direction = np.where(speed_px[:, None] > 0, rate / speed_px[:, None], [1.0, 0.0])
        per_px = self._carried(tracks.centroid_px, direction)
        spread = np.sqrt(np.stack([covariance[:, 0, 0], covariance[:, 1, 1]], axis=1))
        scale = np.linalg.norm(per_px, axis=1)
        extra = {
            **tracks.extra,
            "sigma_x_mm": 1e3 * spread[:, 0],
            "sigma_y_mm": 1e3 * spread[:, 1],
            "sigma_v_mm_s": 1e3 * scale * tracks.extra["sigma_v_px_s"],
        }
        return Tracks(
            frame=tracks.frame,
            time_s=tracks.time_s,
            id=tracks.id,
            centroid_px=tracks.centroid_px,
            box_px=tracks.box_px,
            area_px=tracks.area_px,
            axes_px=tracks.axes_px,
            yaw_rad=self._unwrapped(tracks.id, np.arctan2(axis[:, 1], axis[:, 0])),
            position_m=position,
            velocity_m_s=speed_px[:, None] * per_px,
            extra=extra,
        )

    def _carried(self, at: Float[Array, "n 2"], direction: Float[Array, "n 2"]) -> Float[Array, "n 2"]:
        """Metres on the plane for a pixel along each direction."""
        ends = [self._plane.measure(at + way * direction, z_m=self._z_m)[0] for way in (-STEP_PX, STEP_PX)]
        return (ends[1] - ends[0]) / (2 * STEP_PX)

    def _unwrapped(self, ids: Array, yaw: Float[Array, "n"]) -> Float[Array, "n"]:
        """An axis looks the same after half a turn: each goes on from where it was."""
        whole = yaw.copy()
        for i, one in enumerate(ids.tolist()):
            if np.isfinite(yaw[i]):
                before = self._yaw.get(one, yaw[i])
                whole[i] = yaw[i] + np.pi * np.rint((before - yaw[i]) / np.pi)
                self._yaw[one] = float(whole[i])
        return whole
