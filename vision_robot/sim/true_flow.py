"""Dense true optical flow between two pictures of a cell, from poses and depth."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera, pixel_grid
from vision_robot.sim.truth import TruthFrame
from vision_robot.types import Array, Bool, Float

__all__ = ["TrueFlow", "true_flow"]


@dataclass(frozen=True)
class TrueFlow:
    """Where the point seen at each pixel of one picture lies in another."""

    flow_px: Float[Array, "height width 2"]
    """Displacement (du, dv), float32; NaN where there is none: outside the lens, or led out of its field."""
    occluded: Bool[Array, "height width"]
    """Points that the other picture does not show: hidden there, or outside it."""


def true_flow(before: TruthFrame, after: TruthFrame) -> TrueFlow:
    """Flow from `before` to `after`, any time apart and in either direction; both made with depth.

    Every point seen is carried along by its own body's motion and by the camera's. A point counts as
    hidden where no pixel next to it shows the same body at its distance, to within the footprint of a pixel.
    """
    if before.depth is None or after.depth is None:
        raise BadParameter("frames for a flow", "without depth", "made by TruthRenderer(..., depth=True)")
    if before.camera != after.camera:
        raise BadParameter("cameras of a flow", (before.camera, after.camera), "the same")
    camera = before.camera
    shape = before.bodies.shape
    flow = np.zeros((*shape, 2), dtype=np.float32)
    reach = before.depth.astype(float)  # distance along the axis after the motion, in the other picture
    rays = _rays(camera)
    for body, motion in _motions(before, after).items():
        at = np.nonzero(before.bodies == body)
        moved = _moved(rays[at], before.depth[at], motion)
        flow[at] = camera.project(moved) - np.stack(at[::-1], axis=-1)
        reach[at] = moved[:, 2]
    flow[np.isnan(before.depth)] = np.nan
    return TrueFlow(flow, _hidden(before, after, flow, reach))


def _motions(before: TruthFrame, after: TruthFrame) -> dict[int, SE3]:
    """cam_after_from_cam_before of the points of each body in the picture that moves against the camera.

    Body 0 is what is infinitely far away.
    """
    motions = {}
    seen = np.flatnonzero(np.bincount(before.bodies.ravel(), minlength=1))
    camera_motion = after.cam_from_station @ before.cam_from_station.inverse()
    for body in seen.tolist():
        motion = camera_motion
        if body:
            motion = after.cam_from_body[body - 1] @ before.cam_from_body[body - 1].inverse()
        moves = motion.rotation - np.eye(3), motion.translation
        if max(np.abs(part).max() for part in moves) > 1e-12:
            motions[body] = motion
    return motions


@lru_cache(maxsize=2)
def _rays(camera: Camera) -> Float[Array, "height width 3"]:
    """Directions through the pixels' centres, of length 1 along the optical axis where they point ahead."""
    rays = camera.unproject(pixel_grid(camera.width, camera.height))
    with np.errstate(divide="ignore", invalid="ignore"):
        return rays / rays[..., 2:]


def _moved(rays: Float[Array, "n 3"], depth: Float[Array, "n"], motion: SE3) -> Float[Array, "n 3"]:
    """Points at `depth` along the rays after the motion; those infinitely far away only turn."""
    far = np.isinf(depth)
    points = rays * np.where(far, 1.0, depth)[:, None]
    moved = points @ motion.rotation.T
    moved[~far] += motion.translation
    moved[far] *= 1e9
    return moved


def _hidden(
    before: TruthFrame,
    after: TruthFrame,
    flow: Float[Array, "height width 2"],
    reach: Float[Array, "height width"],
) -> Bool[Array, "height width"]:
    """Which points the other picture does not show."""
    assert after.depth is not None
    height, width = before.bodies.shape
    camera = before.camera
    hidden = np.isnan(flow[..., 0])
    # Where nothing moves and the same body is still seen, nothing is asked.
    row, column = np.nonzero(~hidden & (flow.any(axis=-1) | (after.bodies != before.bodies)))
    body, distance = before.bodies[row, column], reach[row, column]
    u, v = (flow[row, column] + np.stack([column, row], axis=-1)).T
    inside = (u >= -0.5) & (u <= width - 0.5) & (v >= -0.5) & (v <= height - 0.5)
    left, top = (np.floor(np.where(inside, x, 0)).astype(np.int32) for x in (u, v))
    # How far one pixel's width reaches at that distance: slanted surfaces differ by about so much.
    tolerance = np.abs(distance) / min(camera.fx, camera.fy)
    shown = np.zeros(len(row), dtype=bool)
    for du in (0, 1):
        for dv in (0, 1):
            there = np.clip(top + dv, 0, height - 1), np.clip(left + du, 0, width - 1)
            with np.errstate(invalid="ignore"):
                near = np.abs(after.depth[there] - distance) <= tolerance
            shown |= (after.bodies[there] == body) & (near | (body == 0))
    hidden[row, column] = ~(inside & shown)
    return hidden
