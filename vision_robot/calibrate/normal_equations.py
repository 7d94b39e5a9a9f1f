"""The normal equations of a calibration, built block by block.

Cost: half the sum of squared, weighted reprojection errors. Unknowns: the free shared
parameters (intrinsics, then the board's warp) and a pose for each view, perturbed as
R <- Exp(w) R, t <- t + dt in
the order (w, dt). A view's errors depend on no other view's pose, so the Gauss-Newton
matrix has an arrow shape, and only its shared block, its border and its 6x6 diagonal
blocks are kept (Triggs et al. 2000, section 6).
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.state import State
from vision_robot.calibrate.warp import Warp
from vision_robot.geometry import SE3
from vision_robot.types import Array, Float

__all__ = ["NormalEquations", "cost", "normal_equations", "residuals"]

BLOCK_POINTS = 8192
"""Corners handled at once: their Jacobian then stays in the second-level cache."""


@dataclass(frozen=True)
class NormalEquations:
    """``[[shared, border], [border^T, diag(pose)]]`` and the gradient."""

    cost: float
    shared: Float[Array, "p p"]
    border: Float[Array, "views p 6"]
    pose: Float[Array, "views 6 6"]
    shared_gradient: Float[Array, "p"]
    pose_gradient: Float[Array, "views 6"]


def residuals(state: State, seen: Observations) -> Float[Array, "views 2 n"]:
    """Projected minus seen [px]; zero in the padding."""
    camera, views, n = state.camera, *seen.ids.shape
    pose = state.cam_from_board
    points = pose.rotation @ _on_board(state.warp, seen) + pose.translation[..., None]
    distorted = camera.lens.distort(points.transpose(1, 0, 2).reshape(3, -1), camera.distortion)
    x, y = distorted.reshape(2, views, n)
    error = np.stack([camera.fx * x + camera.skew * y + camera.cx, camera.fy * y + camera.cy], axis=1)
    return np.where(seen.present[:, None], error - seen.pixels, 0.0)


def cost(state: State, problem: Problem) -> float:
    """The cost alone: a fifth of the work of `normal_equations`."""
    weighted = residuals(state, problem.seen) * problem.seen.weight[:, None]
    off = (state.shared_parameters - problem.prior_mean)[problem.free]
    return 0.5 * float(np.vdot(weighted, weighted) + problem.prior_information[problem.free] @ off**2)


def normal_equations(state: State, problem: Problem) -> NormalEquations:
    """Evaluate cost, gradient and Gauss-Newton matrix; an infinite cost where a board lies behind."""
    seen, free = problem.seen, problem.free
    views, n = seen.ids.shape
    p = int(free.sum())
    full = np.empty((views, p + 7, p + 7))
    step = max(1, BLOCK_POINTS // max(n, 1))
    blocks = [slice(start, min(start + step, views)) for start in range(0, views, step)]

    rows = np.empty((min(step, views), p + 7, 2 * n))
    visible = True
    for block in blocks:
        J = rows[: block.stop - block.start]
        pose = SE3(state.cam_from_board.rotation[block], state.cam_from_board.translation[block])
        visible = _fill_rows(J, State(state.camera, pose, state.warp), seen[block], free)
        if not visible:
            break
        np.matmul(J, J.transpose(0, 2, 1), out=full[block])
    if not visible:
        full[...] = 0
    total = full[:, :p].sum(axis=0)
    pose_part = slice(p, p + 6)
    known = problem.prior_information[free]
    off = (state.shared_parameters - problem.prior_mean)[free]
    total_cost = float(full[:, -1, -1].sum() + known @ off**2) / 2
    return NormalEquations(
        cost=total_cost if visible else np.inf,
        shared=total[:, :p] + np.diag(known),
        border=full[:, :p, pose_part],
        pose=full[:, pose_part, pose_part],
        shared_gradient=total[:, -1] + known * off,
        pose_gradient=full[:, pose_part, -1],
    )


def _on_board(warp: Warp, seen: Observations) -> Float[Array, "views 3 n"]:
    """Where the board's points really are, in the board frame."""
    if not len(warp):
        return seen.points
    return seen.points + warp.displacement.T[:, seen.ids].transpose(1, 0, 2)


def _fill_rows(J: Float[Array, "views c rows"], state: State, seen: Observations, free: Array) -> bool:
    """Write the weighted Jacobian (shared, w, t) and residual as rows; False if a point is behind."""
    camera, views, n = state.camera, *seen.ids.shape
    rotation = state.cam_from_board.rotation
    arm = rotation @ _on_board(state.warp, seen)  # board points turned, from the board's origin
    in_cam = arm + state.cam_from_board.translation[..., None]
    in_cam = in_cam.transpose(1, 0, 2).reshape(3, -1)
    # What lies before the camera every lens can see: only the rest is worth asking about.
    if in_cam[2].min(initial=1) <= 0 and np.isinf(camera.lens.field(in_cam)).any():
        return False
    distorted, lens = camera.lens.jacobian(in_cam, camera.distortion)
    x, y = distorted.reshape(2, views, n)
    lens = lens.reshape(2, -1, views, n)
    u, v = slice(0, n), slice(n, 2 * n)
    fx, fy, skew = camera.fx, camera.fy, camera.skew

    affine = ((x, 0), (0, y), (1, 0), (0, 1), (y, 0))
    intrinsics = np.flatnonzero(free[: 5 + len(camera.distortion)])
    warps = np.flatnonzero(free[5 + len(camera.distortion) :])
    for row, column in enumerate(intrinsics):
        if column < 5:
            J[:, row, u], J[:, row, v] = affine[column]
        else:
            np.multiply(lens[0, column - 2], fx, out=J[:, row, u])
            if skew:
                J[:, row, u] += skew * lens[1, column - 2]
            np.multiply(lens[1, column - 2], fy, out=J[:, row, v])

    row = len(intrinsics) + len(warps)
    for axis in range(3):
        np.multiply(lens[0, axis], fx, out=J[:, row + 3 + axis, u])
        if skew:
            J[:, row + 3 + axis, u] += skew * lens[1, axis]
        np.multiply(lens[1, axis], fy, out=J[:, row + 3 + axis, v])
    # d(R X)/dw = -[R X]_x, so the row a of the point's Jacobian becomes (R X) x a.
    for half in (u, v):
        a = [J[:, row + 3 + axis, half] for axis in range(3)]
        q = [arm[:, axis] for axis in range(3)]
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            J[:, row + i, half] = q[j] * a[k] - q[k] * a[j]
        if len(warps):
            # A board point moves with its warp, turned into the camera frame.
            in_board = np.einsum("avn,vab->bvn", np.stack(a), rotation)
            for i, k in enumerate(warps):
                field = state.warp.basis[k][:, seen.ids]
                J[:, len(intrinsics) + i, half] = np.einsum("bvn,bvn->vn", in_board, field)
    np.add(fx * x + skew * y, camera.cx - seen.pixels[:, 0], out=J[:, -1, u])
    np.add(fy * y, camera.cy - seen.pixels[:, 1], out=J[:, -1, v])
    if np.any(seen.weight != 1):  # a pass over all rows that equal weights can do without
        J.reshape(views, -1, 2, n)[...] *= seen.weight[:, None, None, :]
    return True
