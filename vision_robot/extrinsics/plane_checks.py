"""What a picture of a plane cannot tell, asked before any number is given."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.errors import AmbiguousPlane, BadParameter, EdgeOnPlane, UnlevelBoard
from vision_robot.extrinsics.board_pose import BoardPose, rival_pose
from vision_robot.geometry import SE3, Camera, rotation_log
from vision_robot.types import Array, Float

__all__ = [
    "Level",
    "check_ambiguity",
    "check_level",
    "check_points",
    "level_of",
    "pose_difference",
    "same_place",
]

FEWEST_POINTS = 4

FLATTEST = np.radians(3)
"""Lines of sight flatter than this see a plane edge-on: every pixel of error counts twenty-fold along it."""

INDISTINCT = 4.0
"""Two minima are told apart when one explains the points so many sigma better."""

SEPARATE = 3.0
"""A rival within so many sigma of the best pose is inside what its covariance says anyway."""

MOVED = 22.5
"""99.9 % point of chi-square with six degrees of freedom."""

UNLEVEL_SIGMA = 6.0
UNLEVEL_SHARE = 0.003
"""A board this far off the first one's plane, as a share of its distance, lies on something else."""
UNLEVEL_ANGLE = np.radians(1.5)


@dataclass(frozen=True)
class Level:
    """How a board found elsewhere lies to the plane of the first: its middle's height [m] and tilt [rad]."""

    image: str
    height_m: float
    sigma_height_m: float
    tilt: float
    sigma_tilt: float


def check_points(view: Corners, board_points: Float[Array, "m 3"]) -> None:
    """Raise BadParameter where the points are too few or on one line."""
    if len(view) < FEWEST_POINTS:
        raise BadParameter(f"points seen in {view.image}", len(view), f"at least {FEWEST_POINTS}")
    if view.ids.max() >= len(board_points):
        raise BadParameter(f"point id in {view.image}", int(view.ids.max()), f"below {len(board_points)}")
    spread = np.linalg.svd(board_points[view.ids] - board_points[view.ids].mean(axis=0), compute_uv=False)
    if spread[1] <= 1e-3 * spread[0]:
        raise BadParameter(f"points seen in {view.image}", "all on one line", "spread over the plane")


def _unit(view: Corners, cost: float, sigma_px: float | None) -> float:
    """Variance of unit weight, from the residuals or from the noise that the caller knows."""
    if sigma_px is not None:
        return float(sigma_px**2 / np.mean(view.sigma_px) ** 2)
    return max(2 * cost / max(2 * len(view) - 6, 1), 1e-22)


def check_level(
    view: Corners, board_points: Float[Array, "m 3"], pose: BoardPose, sigma_px: float | None
) -> None:
    """Raise EdgeOnPlane where the plane is seen so flat that its tilt means nothing."""
    cam_from_board = pose.cam_from_board
    aim = cam_from_board.apply(board_points[view.ids]).mean(axis=0)
    sine = abs(cam_from_board.rotation[:, 2] @ aim) / np.linalg.norm(aim)
    elevation = float(np.arcsin(min(sine, 1.0)))
    offset = view.pixels - view.pixels.mean(axis=0)
    across_px = float(np.linalg.svd(offset, compute_uv=False)[1] / np.sqrt(len(view)))
    noise_px = np.sqrt(_unit(view, pose.cost, sigma_px)) * float(np.mean(view.sigma_px))
    if elevation < FLATTEST or across_px < 3 * noise_px:
        raise EdgeOnPlane(view.image, float(np.degrees(elevation)), across_px)


def check_ambiguity(
    camera: Camera, view: Corners, board_points: Float[Array, "m 3"], pose: BoardPose, sigma_px: float | None
) -> tuple[BoardPose | None, float]:
    """The mirrored pose and by how many sigma it explains the points less well.

    Raises AmbiguousPlane where that is too few for a choice, and the two are not one broad minimum.
    """
    rival = rival_pose(camera, view, board_points, pose)
    if rival is None:
        return None, np.inf
    unit = _unit(view, pose.cost, sigma_px)
    gap = float(np.sqrt(max(2 * (rival.cost - pose.cost), 0.0) / unit))
    between = pose_difference(pose.cam_from_board, rival.cam_from_board)
    apart = float(np.sqrt(max(between @ pose.information @ between, 0.0) / unit))
    if gap < INDISTINCT and apart > SEPARATE:
        angle = np.linalg.norm(between[:3])
        raise AmbiguousPlane(view.image, float(np.degrees(angle)), gap)
    return rival, gap


def pose_difference(first: SE3, second: SE3) -> Float[Array, "6"]:
    """The step (w, dt) from the first pose to the second."""
    turn = rotation_log(second.rotation @ first.rotation.T)
    return np.concatenate([turn, second.translation - first.translation])


def same_place(
    first_view: Corners, first: BoardPose, view: Corners, pose: BoardPose, sigma_px: float | None
) -> bool:
    """Whether two views' boards differ by no more than noise explains."""
    step = pose_difference(first.cam_from_board, pose.cam_from_board)
    covariance = np.zeros((6, 6))
    for one, found in ((first_view, first), (view, pose)):
        covariance += _unit(one, found.cost, sigma_px) * _inverse(found.information)
    scale = 1 / np.sqrt(np.diag(covariance))
    scaled = step * scale
    return bool(scaled @ np.linalg.solve(covariance * scale[:, None] * scale, scaled) <= MOVED)


def level_of(
    first_view: Corners,
    first: BoardPose,
    view: Corners,
    pose: BoardPose,
    board_points: Float[Array, "m 3"],
    station_from_board: SE3,
    sigma_px: float | None,
) -> Level:
    """Height and tilt of a board over the plane of the first, both from their own poses.

    Raises UnlevelBoard where it plainly lies on something else.
    """
    plane = first.cam_from_board @ station_from_board.inverse()
    laid = pose.cam_from_board @ station_from_board.inverse()
    normal = plane.rotation[:, 2]
    on_board = board_points[view.ids].mean(axis=0)
    face = station_from_board.apply(on_board[None])[0]
    middle = pose.cam_from_board.apply(on_board[None])[0]
    away = middle - plane.translation
    height = float(normal @ away - face[2])
    tilt = float(np.arccos(np.clip(normal @ laid.rotation[:, 2], -1, 1)))
    # d height = w1 . (n x away) - n . dt1 + w2 . (arm x n) + n . dt2; w1 turns about the board's own origin.
    from_first = middle - first.cam_from_board.translation
    rows = (
        np.concatenate([np.cross(normal, from_first), -normal]),
        np.concatenate([np.cross(pose.cam_from_board.rotation @ on_board, normal), normal]),
    )
    covariances = [
        _unit(one, found.cost, sigma_px) * _inverse(found.information)
        for one, found in ((first_view, first), (view, pose))
    ]
    variance = sum(float(row @ known @ row) for row, known in zip(rows, covariances, strict=True))
    tilting = sum(float(np.linalg.eigvalsh(known[:3, :3])[-1]) for known in covariances)
    sigma_height, sigma_tilt = float(np.sqrt(variance)), float(np.sqrt(tilting))
    distance = float(np.linalg.norm(middle))
    high = abs(height) > max(UNLEVEL_SIGMA * sigma_height, UNLEVEL_SHARE * distance)
    if high or tilt > max(UNLEVEL_SIGMA * sigma_tilt, UNLEVEL_ANGLE):
        raise UnlevelBoard(view.image, 1000 * height, float(np.degrees(tilt)))
    return Level(view.image, height, sigma_height, tilt, sigma_tilt)


def _inverse(information: Float[Array, "6 6"]) -> Float[Array, "6 6"]:
    scale = 1 / np.sqrt(np.maximum(np.diag(information), 1e-300))
    return scale[:, None] * np.linalg.pinv(information * scale[:, None] * scale, rcond=1e-13) * scale
