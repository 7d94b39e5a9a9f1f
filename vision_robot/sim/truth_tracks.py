"""The truth of many frames as one table of tracks."""

from collections.abc import Iterable

import numpy as np

from vision_robot.sim.object_truth import ObjectTruth
from vision_robot.sim.placing import quaternion
from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float

__all__ = ["truth_tracks"]

ROUND = 2 * np.pi


def truth_tracks(frames: Iterable[tuple[float, ObjectTruth]]) -> Tracks:
    """Tracks from (time [s], truth) of frames 0, 1, 2 and so on; one row a thing and frame, seen or not.

    Ids are those of `TruthFrame.ids`: the place in `Cell.tracked`, from 1. What is not seen has no
    centroid, axes or box, an area of zero, and keeps its position. Yaw is that of the thing's x
    axis in the plane of {S}, running on past half a turn; things without a yaw have none. Further columns:

    - z_mm, qw, qx, qy, qz: the rest of the pose in {S}
    - vz_mm_s, wx_rad_s, wy_rad_s, wz_rad_s: the rest of the velocity
    - centre_u_px, centre_v_px: the picture of the thing's middle
    - amodal_u_px ... amodal_height_px, amodal_area_px: of the whole outline, hidden or not
    - orientation_deg: of the major axis in the picture; occluded, truncated: shares of the outline
    """
    parts = [(i, time, truth) for i, (time, truth) in enumerate(frames)]
    if not parts:
        return Tracks.empty()
    n = len(parts[0][2])
    truths = [truth for _, _, truth in parts]

    def stacked(name: str) -> Array:
        return np.concatenate([getattr(truth, name) for truth in truths])

    R = np.concatenate([truth.station_from_object.rotation for truth in truths])
    t = np.concatenate([truth.station_from_object.translation for truth in truths])
    velocity = stacked("velocity")
    quaternions = np.array([quaternion(r) for r in R]).reshape(-1, 4)
    amodal, centre, whole = stacked("amodal_box_px"), stacked("centre_px"), stacked("amodal_centroid_px")
    extra = {
        "z_mm": 1e3 * t[:, 2],
        **dict(zip(("qw", "qx", "qy", "qz"), quaternions.T, strict=True)),
        "vz_mm_s": 1e3 * velocity[:, 2],
        **dict(zip(("wx_rad_s", "wy_rad_s", "wz_rad_s"), velocity[:, 3:].T, strict=True)),
        **dict(zip(("centre_u_px", "centre_v_px"), centre.T, strict=True)),
        **dict(zip(("amodal_u_px", "amodal_v_px"), whole.T, strict=True)),
        **dict(
            zip(
                ("amodal_left_px", "amodal_top_px", "amodal_width_px", "amodal_height_px"),
                amodal.T,
                strict=True,
            )
        ),
        "amodal_area_px": stacked("amodal_area_px"),
        "orientation_deg": np.degrees(stacked("orientation_rad")),
        "occluded": stacked("occluded"),
        "truncated": stacked("truncated"),
    }
    return Tracks(
        frame=np.repeat([i for i, _, _ in parts], n),
        time_s=np.repeat([time for _, time, _ in parts], n),
        id=np.tile(np.arange(1, n + 1), len(parts)),
        centroid_px=stacked("centroid_px"),
        box_px=stacked("visible_box_px"),
        area_px=stacked("area_px"),
        axes_px=stacked("axes_px"),
        yaw_rad=_yaw(R.reshape(len(parts), n, 3, 3), stacked("has_yaw").reshape(len(parts), n)).ravel(),
        position_m=t[:, :2],
        velocity_m_s=velocity[:, :2],
        extra=extra,
    )


def _yaw(R: Float[Array, "frames n 3 3"], has_yaw: Array) -> Float[Array, "frames n"]:
    """Yaw of each thing, followed from frame to frame."""
    yaw = np.unwrap(np.arctan2(R[..., 1, 0], R[..., 0, 0]), axis=0)
    # A thing that sets out at half a turn shall not start a whole turn away because of the last digit.
    yaw = yaw - ROUND * np.ceil((yaw[:1] - np.pi) / ROUND - 1e-9)
    return np.where(has_yaw, yaw, np.nan)
