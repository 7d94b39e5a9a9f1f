"""Calibrating the cell as a person would: board photos, a board on the table, marks touched by the tool."""

import numpy as np

from vision_robot.arm.ik import InverseKinematics
from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.calibrate.boards import Chessboard
from vision_robot.extrinsics.plane import fit_plane, on_station
from vision_robot.geometry import SE3, KnownCamera, skew
from vision_robot.pick.goal import joints_for, station_from_grasp
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.world import World
from vision_robot.sim.viewpoints import board_poses
from vision_robot.types import Array, Float

__all__ = ["BOARD", "ON_TABLE", "calibrated", "rigid_fit", "rigid_fit_covariance", "touched_station"]

BOARD = Chessboard(9, 6, 0.025)
VIEWS = 15
ON_TABLE = (-0.10, 0.0625)
"""Where the board's first corner lies in {S} for the plane: about the middle of the picture."""

MARKS = np.array([[-0.1, -0.12, 0.0], [-0.1, 0.12, 0.0], [0.1, 0.12, 0.0], [0.1, -0.12, 0.0]])
"""Marks of {S} that the tool touches [m]."""


def calibrated(world: World, seed: int) -> Knowledge:
    """What the controller knows after the cell was set up; the same for the same seed.

    Corners are the true projections with `corner_noise_px`; all else runs as on a real cell: Zhang and
    refinement for the camera, a board lying on the table for the plane, the touched marks for {S} in {B}.
    """
    rng = np.random.default_rng([seed, 1])
    camera, points = world.view.camera, BOARD.points
    size = (camera.width, camera.height)
    width, height = (side - BOARD.origin_m[k] for k, side in enumerate(BOARD.size_m))
    box = (-BOARD.origin_m[0], -BOARD.origin_m[1], width, height)
    poses = board_poses(camera, box, VIEWS, seed=seed)
    views = [_seen(world, poses[i], f"view {i}", rng) for i in range(VIEWS)]
    result = calibrate(views, points, size, Settings(model=world.lens))
    known = KnownCamera(result.camera, result.covariance.intrinsics)
    station_from_board = on_station(ON_TABLE)
    on_table = _seen(world, world.view.cam_from_station @ station_from_board, "table", rng)
    plane = fit_plane(known, [on_table], points, station_from_board).plane
    station, covariance = touched_station(world, rng)
    return Knowledge(plane, station, world.arm, covariance)


def _seen(world: World, cam_from_board: SE3, name: str, rng: np.random.Generator) -> Corners:
    """The board's corners as a detector would find them; a board of wrong squares is larger than it says."""
    real = world.square_scale * BOARD.points
    pixels = world.view.camera.project(cam_from_board.apply(real))
    noisy = pixels + rng.normal(0, world.corner_noise_px, pixels.shape)
    return Corners(name, np.arange(len(real)), noisy, np.full(len(real), world.corner_noise_px))


def touched_station(world: World, rng: np.random.Generator) -> tuple[SE3, Float[Array, "6 6"]]:
    """base_from_station and its covariance, from where the arm believes its tool is on the marks."""
    solver, base, near = InverseKinematics(world.arm), world.design.base_from_station, None
    believed = []
    for mark in MARKS:
        goal = station_from_grasp(mark[:2], 0.0, float(mark[2]))
        near = np.mean(world.arm.chain.limits, axis=1) if near is None else near
        near = joints_for(solver, base, goal, near)
        # The tool is at the mark; where it is believed to be, the encoders tell.
        believed.append(world.arm.chain.base_from_tool(world.told_joints(near)).translation)
    noise = rng.normal(0, world.touch_noise_m, MARKS.shape)
    touched = np.array(believed) + noise
    found = rigid_fit(MARKS, touched)
    return found, rigid_fit_covariance(MARKS, touched, found)


def rigid_fit(points: Float[Array, "n 3"], moved: Float[Array, "n 3"]) -> SE3:
    """The rigid transform that brings `points` nearest to `moved` in least squares (Kabsch 1976)."""
    middle, other = points.mean(axis=0), moved.mean(axis=0)
    U, _, Vt = np.linalg.svd((moved - other).T @ (points - middle))
    R = U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt
    return SE3(R, other - R @ middle)


def rigid_fit_covariance(
    points: Float[Array, "n 3"], moved: Float[Array, "n 3"], fitted: SE3
) -> Float[Array, "6 6"]:
    """Covariance of a rigid fit, (w [rad], dt [m]), its noise per axis taken from what the fit leaves."""
    left = moved - fitted.apply(points)
    variance = float((left**2).sum()) / (left.size - 6)
    turned = points @ fitted.rotation.T
    J = np.concatenate([-skew(turned), np.broadcast_to(np.eye(3), (len(points), 3, 3))], axis=2).reshape(
        -1, 6
    )
    return variance * np.linalg.inv(J.T @ J)
