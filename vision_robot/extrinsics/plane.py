"""The work plane from photos of a board that lies on it, or from points marked on it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.result import Rejected
from vision_robot.calibrate.weighting import trust
from vision_robot.errors import BadParameter
from vision_robot.extrinsics.board_pose import BoardPose, board_pose, pose_jacobian, refined_pose
from vision_robot.extrinsics.plane_checks import (
    Level,
    check_ambiguity,
    check_level,
    check_points,
    level_of,
    same_place,
)
from vision_robot.extrinsics.plane_problem import PlaneState, settle_plane
from vision_robot.geometry import SE3, KnownCamera, WorkPlane
from vision_robot.types import Array, Bool, Float

__all__ = ["PlaneFit", "fit_plane", "on_station"]

CUTOFF = 5.5
"""As for calibration: Gaussian noise reaches it once in 3.7 million points."""

NEVER_OUTLYING_PX = 0.1


@dataclass(frozen=True)
class PlaneFit:
    """A work plane and all that is needed to judge it.

    `residuals` (n, 2) of each view are projected minus seen [px]; `points` (n, 3) where its points lie in
    {S} [m]; `levels` how far each board found elsewhere on the table lies off the plane of the first.
    """

    plane: WorkPlane
    views: tuple[Corners, ...]
    points: tuple[Float[Array, "_ 3"], ...]
    residuals: tuple[Float[Array, "_ 2"], ...]
    noise_px: float
    """Standard deviation of a point per axis that the residuals tell; mean weight where weights differ."""
    degrees_of_freedom: int
    levels: tuple[Level, ...]
    rival: BoardPose | None
    """The mirrored pose that explains the first view less well, where there is one."""
    rival_gap: float
    """How many sigma less well; infinite without a rival."""
    rejected: tuple[Rejected, ...]

    @property
    def rms_px(self) -> float:
        """Root mean square residual per point, both axes together."""
        return float(np.sqrt(np.mean(np.sum(np.concatenate(self.residuals) ** 2, axis=1))))

    @property
    def elevation(self) -> float:
        """Angle between the line of sight to the points and the plane [rad]: pi/2 is straight down."""
        pose = self.plane.cam_from_station
        aim = pose.apply(np.concatenate(self.points)).mean(axis=0)
        return float(np.arcsin(abs(pose.rotation[:, 2] @ aim) / np.linalg.norm(aim)))


def on_station(
    offset_m: tuple[float, float] = (0.0, 0.0), yaw: float = 0.0, height_m: float = 0.0, *, z_up: bool = True
) -> SE3:
    """station_from_board of a board lying on the table, its printed face `height_m` above it.

    Point 0 lies at `offset_m`; the board's x axis is turned by `yaw` [rad] from {S}'s x, about {S}'s z. With
    `z_up` {S} has z up, so that y runs against the board's rows; otherwise its axes are the board's,
    z down into the table.
    """
    turn = SE3.from_rotvec(np.array([0, 0, yaw]), np.array([*offset_m, height_m if z_up else -height_m]))
    over = np.diag([1.0, -1.0, -1.0]) if z_up else np.eye(3)
    return turn @ SE3(over, np.zeros(3))


def fit_plane(
    known: KnownCamera,
    views: Sequence[Corners],
    board_points: Float[Array, "m 3"],
    station_from_board: SE3 | None = None,
    *,
    sigma_px: float | None = None,
    robust: bool = True,
) -> PlaneFit:
    """cam_from_station of one fixed camera, with the joint covariance of camera and pose.

    Args:
        known: The camera; its covariance is carried into the plane's.
        views: What was seen. The first view's board lies in {S} at `station_from_board`; in the others it
            lies at the same place, or flat anywhere else on the same table.
        board_points: The board's points [m], nearly flat.
        station_from_board: Where the first board lies; its own frame is {S} where left out.
        sigma_px: Noise of the points per axis, where it is known better than few residuals tell it.
        robust: Leave out points that noise cannot explain, and name them.

    Raises:
        BadParameter: Too few points, or all on one line.
        EdgeOnPlane: The plane is seen from the side.
        AmbiguousPlane: Two tilts explain the picture equally well.
        UnlevelBoard: A board does not lie on the plane of the first.
        NoConvergence: No pose explains the points.
    """
    views = list(views)
    if not views:
        raise BadParameter("views of the plane", 0, "one or more")
    if sigma_px is not None and not (np.isfinite(sigma_px) and sigma_px > 0):
        raise BadParameter("sigma_px", sigma_px, "positive")
    station_from_board = SE3.identity() if station_from_board is None else station_from_board
    rejected: list[Rejected] = []
    for view in views:
        check_points(view, board_points)
    poses = [board_pose(known.camera, view, board_points) for view in views]
    if robust:
        views, lost = _without_outliers(known, views, board_points, poses)
        rejected += lost
    if sigma_px is None:
        views = _trusted(known, views, board_points, poses)
    poses = [
        refined_pose(known.camera, v, board_points, p.cam_from_board)
        for v, p in zip(views, poses, strict=True)
    ]
    for view, pose in zip(views, poses, strict=True):
        check_points(view, board_points)
        check_level(view, board_points, pose, sigma_px)
    rival, gap = check_ambiguity(known.camera, views[0], board_points, poses[0], sigma_px)
    moved = [
        i for i in range(1, len(views)) if not same_place(views[0], poses[0], views[i], poses[i], sigma_px)
    ]
    levels = tuple(
        level_of(views[0], poses[0], views[i], poses[i], board_points, station_from_board, sigma_px)
        for i in moved
    )
    on_board = [board_points[view.ids] for view in views]
    state = PlaneState.starting(poses, moved, station_from_board)
    state, equations = settle_plane(known.camera, state, views, on_board)
    return _assembled(known, state, equations.matrix, views, on_board, sigma_px, levels, rival, gap, rejected)


def _assembled(
    known: KnownCamera,
    state: PlaneState,
    matrix: Float[Array, "k k"],
    views: list[Corners],
    on_board: list[Float[Array, "_ 3"]],
    sigma_px: float | None,
    levels: tuple[Level, ...],
    rival: BoardPose | None,
    gap: float,
    rejected: list[Rejected],
) -> PlaneFit:
    points = [state.in_station(i, on_board[i]) for i in range(len(views))]
    rows, weights, in_camera, residuals = [], [], [], []
    for i, view in enumerate(views):
        pixels, in_pose, in_known, _ = pose_jacobian(known.camera, state.cam_from_station, points[i])
        rows.append(state.rows(i, in_pose, points[i]))
        in_camera.append(in_known.reshape(-1, in_known.shape[2]))
        residuals.append(pixels - view.pixels)
        weights.append(np.repeat(1 / view.sigma_px, 2))
    J, B = np.concatenate(rows), np.concatenate(in_camera)
    w = np.concatenate(weights)
    flat = np.concatenate([r.reshape(-1) for r in residuals])
    dof = max(len(flat) - J.shape[1], 1)
    unit = sigma_px**2 if sigma_px is not None else float(np.sum((w * flat) ** 2)) / dof
    if sigma_px is not None:
        unit /= float(np.mean(1 / w) ** 2)
    # The camera is held: an error db of it moves the minimum by -(J^T W J)^-1 J^T W B db.
    scale = 1 / np.sqrt(np.diag(matrix))
    inverse = scale[:, None] * np.linalg.inv(matrix * scale[:, None] * scale) * scale
    follow = -inverse @ ((J * w[:, None] ** 2).T @ B)
    own = unit * inverse[:6, :6]
    p = len(known.covariance)
    joint = np.zeros((p + 6, p + 6))
    joint[:p, :p] = known.covariance
    joint[p:, :p] = follow[:6] @ known.covariance
    joint[:p, p:] = joint[p:, :p].T
    joint[p:, p:] = own + follow[:6] @ known.covariance @ follow[:6].T
    return PlaneFit(
        plane=WorkPlane(known.camera, state.cam_from_station, joint),
        views=tuple(views),
        points=tuple(points),
        residuals=tuple(residuals),
        noise_px=float(np.sqrt(unit) * np.mean(1 / w)),
        degrees_of_freedom=dof,
        levels=levels,
        rival=rival,
        rival_gap=gap,
        rejected=tuple(rejected),
    )


def _trusted(
    known: KnownCamera, views: list[Corners], board_points: Float[Array, "m 3"], poses: list[BoardPose]
) -> list[Corners]:
    """The views with their points weighed by what the residuals say of the detector's word."""
    lengths = [
        np.linalg.norm(known.camera.project(p.cam_from_board.apply(board_points[v.ids])) - v.pixels, axis=1)
        for v, p in zip(views, poses, strict=True)
    ]
    believed = trust(np.concatenate(lengths), np.concatenate([view.sigma_px for view in views]))
    if max(believed.scale, believed.floor_px) < EXACT_PX:
        return views
    return [Corners(v.image, v.ids, v.pixels, believed.sigma(v.sigma_px)) for v in views]


EXACT_PX = 1e-8
"""Residuals of this size are rounding."""


def _without_outliers(
    known: KnownCamera, views: list[Corners], board_points: Float[Array, "m 3"], poses: list[BoardPose]
) -> tuple[list[Corners], list[Rejected]]:
    """Leave out points that a robust fit of their view cannot explain."""
    kept, rejected = [], []
    for view, pose in zip(views, poses, strict=True):
        stay = np.ones(len(view), dtype=bool)
        if len(view) >= FEWEST_TO_JUDGE:
            stay = _explained(known, view, board_points, pose)
        rejected += [
            Rejected(view.image, "it lies farther off than noise explains", corner=int(i))
            for i in view.ids[~stay]
        ]
        kept.append(Corners(view.image, view.ids[stay], view.pixels[stay], view.sigma_px[stay]))
    return kept, rejected


def _explained(
    known: KnownCamera, view: Corners, board_points: Float[Array, "m 3"], pose: BoardPose
) -> Bool[Array, "n"]:
    """Which points lie within `CUTOFF` of a Cauchy fit (Zhang 1997), which outliers hardly pull."""
    loose = np.sqrt(len(view) / (len(view) - 3))  # six unknowns make 2 n residuals smaller by this
    stay: Array = np.ones(len(view), dtype=bool)
    for _ in range(ROUNDS):
        pixels = known.camera.project(pose.cam_from_board.apply(board_points[view.ids]))
        off_px = np.linalg.norm(pixels - view.pixels, axis=1)
        length = off_px / view.sigma_px
        spread = max(float(np.median(length)) / RAYLEIGH_MEDIAN * loose, 1e-9)
        stay = np.logical_or(length <= CUTOFF * spread, off_px <= NEVER_OUTLYING_PX)
        pull = np.sqrt(1 + (length / (CAUCHY_TUNING * spread)) ** 2)
        softened = Corners(view.image, view.ids, view.pixels, view.sigma_px * pull)
        pose = refined_pose(known.camera, softened, board_points, pose.cam_from_board)
    return stay


FEWEST_TO_JUDGE = 7
"""With fewer points the others cannot outvote one."""

ROUNDS = 12
RAYLEIGH_MEDIAN = 1.1774
CAUCHY_TUNING = 2.385
