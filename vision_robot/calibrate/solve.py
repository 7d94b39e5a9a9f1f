"""From corners to a calibrated camera."""

from collections.abc import Sequence

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.identifiability import identified
from vision_robot.calibrate.normal_equations import residuals
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.outliers import explained
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.refine import Refinement, refine
from vision_robot.calibrate.result import CalibrationResult, Rejected
from vision_robot.calibrate.settings import Settings
from vision_robot.calibrate.settle import settle
from vision_robot.calibrate.state import State
from vision_robot.calibrate.warp import Warp
from vision_robot.calibrate.weighting import trust
from vision_robot.errors import TooFewViews
from vision_robot.types import Array, Bool, Float

__all__ = ["calibrate"]

FEWEST_VIEWS = 3
FEWEST_CORNERS = 6
"""A pose takes six of a view's measured numbers; a view must leave some over."""

TYPICAL_NOISE_PX = 0.2
"""Weighs priors against corners until the residuals tell the noise."""


def calibrate(
    corners: Sequence[Corners],
    board_points: Float[Array, "m 3"],
    size: tuple[int, int],
    settings: Settings | None = None,
    *,
    rejected: Sequence[Rejected] = (),
) -> CalibrationResult:
    """Calibrate one camera from corners seen on a planar board.

    Args:
        corners: One entry for each picture in which the board was found.
        board_points: Board points (m, 3) [m] in the board frame, z = 0.
        size: Width and height of the pictures [px].
        settings: Which camera is fitted, and how; `Settings()` where left out.
        rejected: Pictures already left out, carried into the result.

    Raises:
        TooFewViews: Fewer than three usable views.
        DegenerateViews: The views leave parameters undetermined; they are named.
        NoConvergence: The descent did not settle.
    """
    settings = settings or Settings()
    given = len(corners) + len(rejected)
    views, seen, left_out = _usable(corners, board_points)
    if len(views) < FEWEST_VIEWS:
        raise TooFewViews(len(views), FEWEST_VIEWS, given)
    warp = Warp.smooth(board_points, settings.warp)
    problem = _problem(seen, settings, warp, TYPICAL_NOISE_PX)
    end = settle(problem, size, settings, warp)
    end, problem = _trusted(end, problem)
    if settings.robust:
        end, problem, views, outliers = _without_outliers(end, problem, views)
        left_out += outliers
        if len(views) < FEWEST_VIEWS:
            raise TooFewViews(len(views), FEWEST_VIEWS, given)
    if settings.priors:
        noise = float(np.sqrt(2 * end.equations.cost / max(problem.degrees_of_freedom, 1)))
        problem = _problem(problem.seen, settings, warp, max(noise, 1e-6)).trusting(problem.trust)
        end = refine(end.state, problem)
    known = identified(end, problem)
    errors, present = residuals(end.state, problem.seen), problem.seen.present
    return CalibrationResult(
        camera=end.state.camera,
        cam_from_board=end.state.cam_from_board,
        warp=end.state.warp,
        corners=tuple(_kept(view, used) for view, used in zip(views, problem.seen.ids, strict=True)),
        residuals=tuple(e[:, p].T for e, p in zip(errors, present, strict=True)),
        covariance=known,
        settings=settings,
        trust=problem.trust,
        rejected=(*rejected, *left_out),
        iterations=end.iterations,
    )


def _problem(seen: Observations, settings: Settings, warp: Warp, noise_px: float) -> Problem:
    problem = Problem.plain(seen, np.concatenate([settings.free, np.ones(len(warp), dtype=bool)]))
    for name, (mean, sigma) in settings.priors.items():
        i = settings.names.index(name)
        problem.prior_mean[i] = mean
        problem.prior_information[i] = (noise_px / sigma) ** 2
    return problem


def _usable(
    corners: Sequence[Corners], board_points: Array
) -> tuple[list[Corners], Observations, list[Rejected]]:
    """Views with enough corners, not all on one line of the board."""
    kept, rejected = [], []
    for view in corners:
        if len(view) >= FEWEST_CORNERS:
            kept.append(view)
        else:
            rejected.append(Rejected(view.image, f"{len(view)} corners found, {FEWEST_CORNERS} needed"))
    seen = Observations.of(kept, board_points)
    present = seen.present
    centre = seen.points.sum(axis=2) / np.maximum(present.sum(axis=1), 1)[:, None]
    offset = np.where(present[:, None], seen.points - centre[..., None], 0.0)
    spread = np.linalg.eigvalsh(offset @ offset.transpose(0, 2, 1))  # the middle one is the board's width
    wide: Array = spread[:, 1] > 1e-6 * spread[:, 2]
    for view, is_wide in zip(kept, wide, strict=True):
        if not is_wide:
            rejected.append(Rejected(view.image, "all corners lie on one line of the board"))
    kept = [view for view, is_wide in zip(kept, wide, strict=True) if is_wide]
    return kept, seen if wide.all() else seen[wide], rejected


def _trusted(end: Refinement, problem: Problem) -> tuple[Refinement, Problem]:
    """Weigh corners by what the residuals say of the detector's word, and settle again."""
    seen = problem.seen
    if np.ptp(seen.sigma_px[seen.present]) <= 1e-9:
        return end, problem
    for _ in range(2):
        lengths = np.linalg.norm(residuals(end.state, seen), axis=1)
        problem = problem.trusting(trust(lengths[seen.present], seen.sigma_px[seen.present]))
        end = refine(end.state, problem)
    return end, problem


def _without_outliers(
    end: Refinement, problem: Problem, views: list[Corners]
) -> tuple[Refinement, Problem, list[Corners], list[Rejected]]:
    """Leave out what a robust fit cannot explain, until all that is left is explained."""
    rejected: list[Rejected] = []
    for _ in range(10):
        seen = problem.seen
        keep = explained(end.state, problem)
        if (keep == seen.present).all():
            break
        rejected += _named(views, seen, keep)
        alive: Array = np.any(keep, axis=1)
        views = [view for view, is_alive in zip(views, alive, strict=True) if is_alive]
        if len(views) < FEWEST_VIEWS:
            break
        problem = problem.of(seen.keeping(keep)[alive])
        state = State(end.state.camera, end.state.cam_from_board[alive], end.state.warp)
        end, problem = _trusted(refine(state, problem), problem)
    return end, problem, views, rejected


def _named(views: list[Corners], seen: Observations, keep: Bool[Array, "views n"]) -> list[Rejected]:
    """The reasons, per view and per corner."""
    rejected = []
    for view, ids, present, kept in zip(views, seen.ids, seen.present, keep, strict=True):
        lost = ids[present & ~kept]
        if not kept.any():
            reason = "too many of its corners lie where no pose of the board explains them"
            rejected.append(Rejected(view.image, reason))
        else:
            reason = "it lies farther off than noise explains"
            rejected += [Rejected(view.image, reason, corner=int(i)) for i in lost]
    return rejected


def _kept(view: Corners, used: Array) -> Corners:
    """The corners of a view that were used, in the order of its table row."""
    if np.count_nonzero(used >= 0) == len(view):
        return view
    keep = np.isin(view.ids, used)
    return Corners(view.image, view.ids[keep], view.pixels[keep], view.sigma_px[keep])
