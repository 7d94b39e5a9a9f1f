"""The pose of known points in one picture: closed form, then the minimum; and its rival.

A plane seen far away or nearly face-on looks the same from two tilts, mirrored about the line of
sight (Oberkampf, DeMenthon & Davis 1996; Schweighofer & Pinz 2006). Both minima are sought, so that
a pose is never given without knowing whether the other explains the picture as well.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.start import poses_from_bearings
from vision_robot.errors import NoConvergence
from vision_robot.extrinsics.descent import DenseEquations, dense_step, descend
from vision_robot.geometry import SE3, Camera, rotation_exp, rotation_log, skew
from vision_robot.types import Array, Float

__all__ = ["BoardPose", "board_pose", "moved_pose", "pose_jacobian", "refined_pose", "rival_pose"]


@dataclass(frozen=True)
class BoardPose:
    """A minimum of the reprojection error over a pose.

    `information` (6, 6) is the Gauss-Newton matrix of (w, dt) and `cost` half the sum of squares, both
    in units of the points' weights.
    """

    cam_from_board: SE3
    information: Float[Array, "6 6"]
    cost: float


def pose_jacobian(
    camera: Camera, pose: SE3, points: Float[Array, "n 3"]
) -> tuple[Float[Array, "n 2"], Float[Array, "n 2 6"], Float[Array, "n 2 p"], Float[Array, "n 2 3"]]:
    """Pixels of points, and their derivatives in (w, dt) of the pose, in the camera, in the point."""
    turned = points @ pose.rotation.T
    pixels, in_cam, in_camera = camera.project_jacobian(turned + pose.translation)
    in_pose = np.concatenate([-in_cam @ skew(turned), in_cam], axis=2)
    return pixels, in_pose, in_camera, in_cam @ pose.rotation


def moved_pose(pose: SE3, step: Float[Array, "*batch 6"]) -> SE3:
    """R <- Exp(w) R, t <- t + dt."""
    return SE3(rotation_exp(step[..., :3]) @ pose.rotation, pose.translation + step[..., 3:])


def board_pose(camera: Camera, view: Corners, board_points: Float[Array, "m 3"]) -> BoardPose:
    """The best pose of a nearly flat board; raises NoConvergence where none explains the picture."""
    start = poses_from_bearings(camera, Observations.of([view], board_points))[0]
    best = refined_pose(camera, view, board_points, start)
    rival = rival_pose(camera, view, board_points, best)
    return rival if rival is not None and rival.cost < best.cost else best


def refined_pose(camera: Camera, view: Corners, board_points: Float[Array, "m 3"], start: SE3) -> BoardPose:
    """The minimum into which `start` falls."""
    points, weight = board_points[view.ids], 1 / view.sigma_px[:, None]

    def evaluate(pose: SE3) -> DenseEquations:
        pixels, in_pose, _, _ = pose_jacobian(camera, pose, points)
        residual = (pixels - view.pixels) * weight
        return DenseEquations.of((in_pose * weight[..., None]).reshape(-1, 6), residual.reshape(-1))

    dof = max(2 * len(view) - 6, 1)
    end = descend(
        start,
        evaluate=evaluate,
        solve=dense_step,
        move=moved_pose,
        variance=lambda found: 2 * found.cost / dof,
        what=f"the board's pose in {view.image}",
    )
    return BoardPose(end.state, end.equations.matrix, end.equations.cost)


def rival_pose(
    camera: Camera, view: Corners, board_points: Float[Array, "m 3"], best: BoardPose
) -> BoardPose | None:
    """The other minimum, with the tilt mirrored about the line of sight; None where there is none."""
    points = board_points[view.ids]
    pose, middle = best.cam_from_board, points.mean(axis=0)
    aim = pose.rotation @ middle + pose.translation
    sight = aim / np.linalg.norm(aim)
    mirror = np.eye(3) - 2 * np.outer(sight, sight)
    # Mirroring depth about the middle and the board's own normal: what is left is a rotation.
    normal = np.linalg.svd(points - middle)[2][2]
    rotation = mirror @ pose.rotation @ (np.eye(3) - 2 * np.outer(normal, normal))
    try:
        other = refined_pose(camera, view, board_points, SE3(rotation, aim - rotation @ middle))
    except NoConvergence:
        return None
    apart = rotation_log(other.cam_from_board.rotation @ pose.rotation.T)
    return None if np.linalg.norm(apart) < SAME else other


SAME = 1e-4
"""Two descents that end closer than this [rad] ended in one minimum."""
