"""Dense true optical flow between two pictures of a cell, from poses and depth."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera, pixel_grid
from vision_robot.sim.truth import TruthFrame
from vision_robot.types import Array, Bool, Float, Integer

__all__ = ["TrueFlow", "true_flow"]

ON_CENTRE_PX = 1e-3


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
    height, width = before.bodies.shape
    moves, R, t = _motions(before, after)
    body = before.bodies.ravel()
    at = np.flatnonzero(moves[body])
    mine = body[at]
    moved = _moved(_rays(camera)[:, at], before.depth.ravel()[at], R, t, mine)
    flow = np.zeros((height * width, 2), dtype=np.float32)
    row, column = np.divmod(at, width)
    flow[at] = camera.project(moved.T) - np.stack([column, row], axis=-1)
    unseen = np.isnan(before.depth.ravel())
    if unseen.any():
        flow[unseen] = np.nan
    reach = before.depth.ravel().copy()
    reach[at] = moved[2]
    # Where nothing moves and the same body is still seen, nothing needs to be asked.
    asked = np.flatnonzero((moves[body] | (after.bodies.ravel() != body)) & ~unseen)
    hidden = unseen
    hidden[asked] = _hidden(after, asked, body[asked], flow[asked], reach[asked])
    return TrueFlow(flow.reshape(height, width, 2), hidden.reshape(height, width))


def _motions(
    before: TruthFrame, after: TruthFrame
) -> tuple[Bool[Array, "numbers"], Float[Array, "numbers 3 3"], Float[Array, "numbers 3"]]:
    """Which bodies move against the camera, and cam_after_from_cam_before of the points of each.

    Body 0 is what is infinitely far away: it moves as the camera does.
    """
    camera_motion = after.cam_from_station @ before.cam_from_station.inverse()
    motion = after.cam_from_body @ before.cam_from_body.inverse()
    R = np.concatenate([camera_motion.rotation[None], motion.rotation])
    t = np.concatenate([camera_motion.translation[None], motion.translation])
    change = np.maximum(np.abs(R - np.eye(3)).max(axis=(1, 2)), np.abs(t).max(axis=1))
    return change > 1e-12, R, t


@lru_cache(maxsize=2)
def _rays(camera: Camera) -> Float[Array, "3 pixels"]:
    """Directions through the pixels' centres, 1 along the optical axis, row by row."""
    rays = camera.unproject(pixel_grid(camera.width, camera.height)).reshape(-1, 3)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.ascontiguousarray((rays / rays[:, 2:]).T)


def _moved(
    rays: Float[Array, "3 n"],
    depth: Float[Array, "n"],
    R: Float[Array, "numbers 3 3"],
    t: Float[Array, "numbers 3"],
    body: Integer[Array, "n"],
) -> Float[Array, "3 n"]:
    """Points at `depth` along the rays after their bodies' motions; those infinitely far away only turn."""
    moved = np.empty_like(rays)
    for one in np.flatnonzero(np.bincount(body, minlength=1)).tolist():
        mine = np.flatnonzero(body == one)
        far = one == 0
        x, y, z = rays[:, mine] * (1e9 if far else depth[mine])
        for i in range(3):
            # Written out: for so thin a matrix product BLAS wakes all cores, which other workers need.
            turned = R[one, i, 0] * x + R[one, i, 1] * y + R[one, i, 2] * z
            moved[i, mine] = turned if far else turned + t[one, i]
    return moved


def _hidden(
    after: TruthFrame,
    at: Integer[Array, "n"],
    body: Integer[Array, "n"],
    flow: Float[Array, "n 2"],
    reach: Float[Array, "n"],
) -> Bool[Array, "n"]:
    """Which of the points that come from the pixels `at`, `reach` away after the motion, are not shown."""
    assert after.depth is not None
    height, width = after.bodies.shape
    row, column = np.divmod(at, width)
    with np.errstate(invalid="ignore"):
        u, v = column + flow[:, 0], row + flow[:, 1]
        inside = (u >= -0.5) & (u <= width - 0.5) & (v >= -0.5) & (v <= height - 0.5)
    u, v = np.where(inside, u, 0), np.where(inside, v, 0)
    # How far one pixel's width reaches at that distance: slanted surfaces differ by about so much.
    tolerance = np.abs(reach) / min(after.camera.fx, after.camera.fy)
    bodies, depths = after.bodies.ravel(), after.depth.ravel()

    def seen(side: Float[Array, "k"], line: Float[Array, "k"], of: Integer[Array, "k"]) -> Bool[Array, "k"]:
        there = np.clip(line, 0, height - 1) * width + np.clip(side, 0, width - 1)
        there = there.astype(np.intp)
        with np.errstate(invalid="ignore"):
            near = np.abs(depths[there] - reach[of]) <= tolerance[of]
        return (bodies[there] == body[of]) & (near | (body[of] == 0))

    # The pixels next to it, one alone where the point lies on its centre; for most the nearest will do.
    shown = seen(np.rint(u), np.rint(v), np.arange(len(at)))
    left = np.flatnonzero(inside & ~shown)
    u, v = u[left], v[left]
    for side in (np.floor(u + ON_CENTRE_PX), np.ceil(u - ON_CENTRE_PX)):
        for line in (np.floor(v + ON_CENTRE_PX), np.ceil(v - ON_CENTRE_PX)):
            shown[left] |= seen(side, line, left)
    return ~(inside & shown)
