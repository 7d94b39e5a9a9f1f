"""Where the board stood in each picture, by the picture alone: what the arm is compared with."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.normal_equations import residuals
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.outliers import explained
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.refine import refine
from vision_robot.calibrate.result import Rejected
from vision_robot.calibrate.start import poses_from_bearings
from vision_robot.calibrate.state import State
from vision_robot.calibrate.warp import Warp
from vision_robot.calibrate.weighting import Trust, trust
from vision_robot.geometry import SE3, Camera, rotation_exp
from vision_robot.types import Array, Bool, Float

__all__ = ["BoardViews", "find_board_poses"]

FEWEST_CORNERS = 6


@dataclass(frozen=True)
class BoardViews:
    """Pictures of one board through a known camera, each with the board's pose.

    `problem` holds the corners, weighed by 1/sigma with the sigma that the residuals tell, so that
    squares of weighted residuals have mean one; `state` the camera and `cam_from_board`.
    """

    state: State
    problem: Problem
    noise_px: float
    """Standard deviation of a corner per axis [px]."""

    def __len__(self) -> int:
        return len(self.state.cam_from_board)

    @property
    def cam_from_board(self) -> SE3:
        """The board's pose in each picture."""
        return self.state.cam_from_board

    def keeping(self, keep: Bool[Array, "views"]) -> "BoardViews":
        """Some of the views."""
        state = State(self.state.camera, self.state.cam_from_board[keep], self.state.warp)
        return BoardViews(state, self.problem.of(self.problem.seen[keep]), self.noise_px)


def find_board_poses(
    corners: Sequence[Corners], board_points: Float[Array, "m 3"], camera: Camera, *, robust: bool = True
) -> tuple[BoardViews, Bool[Array, "given"], list[Rejected]]:
    """Poses of the board, which of the given views have one, and what was left out and why."""
    rejected = [
        Rejected(view.image, f"{len(view)} corners found, {FEWEST_CORNERS} needed")
        for view in corners
        if len(view) < FEWEST_CORNERS
    ]
    usable = np.array([len(view) >= FEWEST_CORNERS for view in corners], dtype=bool)
    views = [view for view in corners if len(view) >= FEWEST_CORNERS]
    warp = Warp.smooth(board_points, 0)
    problem = Problem.plain(
        Observations.of(views, board_points), np.zeros(len(camera.parameters), dtype=bool)
    )
    state = State(camera, poses_from_bearings(camera, problem.seen), warp)
    finite = np.isfinite(state.cam_from_board.as_matrix()).all(axis=(1, 2))
    finite &= state.cam_from_board.translation[:, 2] != 0
    if not finite.all():
        reason = "the lens does not see its corners: is it the right camera file?"
        rejected += [Rejected(v.image, reason) for v, ok in zip(views, finite, strict=True) if not ok]
        usable[np.flatnonzero(usable)[~finite]] = False
        state = State(camera, state.cam_from_board[finite], warp)
        problem = problem.of(problem.seen[finite])
        views = [view for view, ok in zip(views, finite, strict=True) if ok]
    if not views:
        return BoardViews(state, problem, 0.0), usable, rejected
    state = _better_of_two(state, problem)
    if robust:
        keep = explained(state, problem)
        alive: Array = np.any(keep, axis=1)
        rejected += _named(views, problem, keep)
        usable[np.flatnonzero(usable)[~alive]] = False
        problem = problem.of(problem.seen.keeping(keep)[alive])
        state = State(camera, state.cam_from_board[alive], warp)
        if alive.any() and not keep[alive].all():
            state = refine(state, problem).state
    problem, noise = _weighed(state, problem)
    return BoardViews(state, problem, noise), usable, rejected


def _better_of_two(state: State, problem: Problem) -> State:
    """Refine from the pose found and from its mirror image about the line of sight; keep the better.

    A plane seen small or from afar fits two poses nearly alike (Schweighofer & Pinz 2006).
    """
    first = refine(state, problem).state
    pose = first.cam_from_board
    middle = problem.seen.points.mean(axis=2)  # padding pulls it to the origin, which does no harm
    centre = pose.apply(middle[:, None])[:, 0]
    sight = centre / np.linalg.norm(centre, axis=1, keepdims=True)
    normal = pose.rotation[..., 2]
    axis = np.cross(normal, sight)
    sine = np.linalg.norm(axis, axis=1, keepdims=True)
    turn = 2 * np.arctan2(sine, (normal * sight).sum(axis=1, keepdims=True)) * axis / np.maximum(sine, 1e-9)
    rotation = rotation_exp(turn) @ pose.rotation
    mirrored = SE3(rotation, centre - (rotation @ middle[..., None])[..., 0])
    second = refine(State(state.camera, mirrored, state.warp), problem, tolerance=0.1).state
    better = _cost(second, problem) < _cost(first, problem) * (1 - 1e-6)
    if not better.any():
        return first
    pose = SE3(
        np.where(better[:, None, None], second.cam_from_board.rotation, pose.rotation),
        np.where(better[:, None], second.cam_from_board.translation, pose.translation),
    )
    return refine(State(state.camera, pose, state.warp), problem).state


def _cost(state: State, problem: Problem) -> Float[Array, "views"]:
    """Squared weighted error of each view; infinite where a part of the board lies behind the camera."""
    squared = (residuals(state, problem.seen) * problem.seen.weight[:, None]) ** 2
    behind = (state.cam_from_board.apply(problem.seen.points.transpose(0, 2, 1))[..., 2] <= 0).any(axis=1)
    return np.where(behind, np.inf, squared.sum(axis=(1, 2)))


def _weighed(state: State, problem: Problem) -> tuple[Problem, float]:
    """Corners weighed so that their weighted residuals have variance one, and the noise per axis [px]."""
    seen = problem.seen
    present = seen.present
    lengths = np.linalg.norm(residuals(state, seen), axis=1)[present]
    stated = seen.sigma_px[present]
    problem = problem.trusting(trust(lengths, stated))
    weight = problem.seen.weight[present]
    freedom = max(2 * int(present.sum()) - 6 * seen.views, 1)
    unit = max(float(np.sqrt(np.sum((lengths * weight) ** 2) / freedom)), 1e-9)
    found = problem.trust
    problem = problem.trusting(Trust(found.scale * unit, found.floor_px * unit))
    sigma = problem.trust.sigma(stated)
    return problem, float(np.sqrt(np.mean(sigma**2)))


def _named(views: Sequence[Corners], problem: Problem, keep: Bool[Array, "views n"]) -> list[Rejected]:
    """The reasons, per view and per corner."""
    rejected = []
    for view, ids, present, kept in zip(views, problem.seen.ids, problem.seen.present, keep, strict=True):
        if not kept.any():
            rejected.append(
                Rejected(view.image, "too many of its corners lie where no pose of the board explains them")
            )
        else:
            reason = "it lies farther off than noise explains"
            rejected += [Rejected(view.image, reason, corner=int(i)) for i in ids[present & ~kept]]
    return rejected
