"""From corners to a calibrated camera."""

from collections.abc import Sequence

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.covariance import Covariance, covariance
from vision_robot.calibrate.normal_equations import residuals
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.refine import Refinement, refine
from vision_robot.calibrate.result import CalibrationResult, Rejected
from vision_robot.calibrate.start import poses_from_bearings, start
from vision_robot.calibrate.state import State
from vision_robot.calibrate.warp import Warp
from vision_robot.errors import BadParameter, DegenerateViews, NoConvergence, TooFewViews
from vision_robot.geometry import SE3, lens_named
from vision_robot.geometry.camera import AFFINE_NAMES
from vision_robot.types import Array, Bool, Float

__all__ = ["calibrate"]

VIEWS_FOR_START = 40
FEWEST_VIEWS = 3
FEWEST_CORNERS = 6
"""A pose takes six of a view's measured numbers; a view must leave some over."""


def calibrate(
    corners: Sequence[Corners],
    board_points: Float[Array, "m 3"],
    size: tuple[int, int],
    *,
    model: str = "brown5",
    skew: bool = False,
    fixed: Sequence[str] = (),
    rejected: Sequence[Rejected] = (),
) -> CalibrationResult:
    """Calibrate one camera from corners seen on a planar board.

    Args:
        corners: One entry for each picture in which the board was found.
        board_points: Board points (m, 3) [m] in the board frame, z = 0.
        size: Width and height of the pictures [px].
        model: Lens model: pinhole, brown5, brown8 or fisheye.
        skew: Estimate the skew of the pixel axes too.
        fixed: Names of lens coefficients to hold at zero.
        rejected: Pictures already left out, carried into the result.

    Raises:
        TooFewViews: Fewer than three usable views.
        DegenerateViews: The views leave parameters undetermined; they are named.
        NoConvergence: The descent did not settle.
    """
    usable, seen, left_out = _usable(corners, board_points)
    rejected = [*rejected, *left_out]
    if len(usable) < FEWEST_VIEWS:
        raise TooFewViews(len(usable), FEWEST_VIEWS, len(corners) + len(rejected) - len(left_out))
    free = _free(model, skew, fixed)
    warp = Warp.none(len(board_points))
    end = _settle(seen, size, free, model=model, skew=skew, warp=warp)
    uncertainty = _known(end, seen, free)
    errors = residuals(end.state, seen)
    return CalibrationResult(
        camera=end.state.camera,
        cam_from_board=end.state.cam_from_board,
        corners=tuple(usable),
        residuals=tuple(e[:, p].T for e, p in zip(errors, seen.present, strict=True)),
        covariance=uncertainty,
        free=tuple(bool(f) for f in free),
        rejected=tuple(rejected),
        iterations=end.iterations,
    )


def _settle(
    seen: Observations, size: tuple[int, int], free: Array, *, model: str, skew: bool, warp: Warp
) -> Refinement:
    """From nothing to the minimum.

    A large set is settled on some of its views first: all the steps but the last few are
    then cheap.
    """
    few = seen
    if seen.views > 2 * VIEWS_FOR_START:
        few = seen[np.linspace(0, seen.views - 1, VIEWS_FOR_START).astype(int)]
    state = start(few, size, model=model, skew=skew, warp=warp)
    try:
        end = _refine_in_stages(state, few, free)
    except NoConvergence:
        _refuse_parallel(state.cam_from_board)
        raise
    if few is seen:
        return end
    camera = end.state.camera
    return refine(State(camera, poses_from_bearings(camera, seen), end.state.warp), seen, free)


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
    wide = spread[:, 1] > 1e-6 * spread[:, 2]
    for view, is_wide in zip(kept, wide, strict=True):
        if not is_wide:
            rejected.append(Rejected(view.image, "all corners lie on one line of the board"))
    kept = [view for view, is_wide in zip(kept, wide, strict=True) if is_wide]
    return kept, seen[wide] if not wide.all() else seen, rejected


def _free(model: str, skew: bool, fixed: Sequence[str]) -> Bool[Array, "p"]:
    names = lens_named(model).coefficient_names
    for name in fixed:
        if name not in names:
            raise BadParameter("fixed parameter", name, f"one of {', '.join(names) or 'none for pinhole'}")
    return np.array([True] * 4 + [skew] + [name not in fixed for name in names])


def _refine_in_stages(state: State, seen: Observations, free: Array) -> Refinement:
    """Refine all at once; where that fails, first without the lens, then with it."""
    try:
        return refine(state, seen, free)
    except NoConvergence:
        affine = free & (np.arange(len(free)) < 5)
        few = affine | (free & (np.arange(len(free)) < 7))
        for stage in (affine, few):
            state = refine(state, seen, stage, tolerance=0.1).state
        return refine(state, seen, free, max_iterations=300)


def _known(end: Refinement, seen: Observations, free: Array) -> Covariance:
    """The covariance, or DegenerateViews naming what the views cannot tell."""
    dof = 2 * int(seen.present.sum()) - int(free.sum()) - 6 * seen.views
    variance = 2 * end.equations.cost / max(dof, 1)
    known = covariance(end.equations, free, end.state.shared_names, variance)
    if set(known.undetermined) & set(AFFINE_NAMES):
        raise DegenerateViews(known.undetermined, "the equations leave them free")
    camera = end.state.camera
    sigma = dict(zip(end.state.shared_names, known.sigma, strict=True))
    limits = {"fx": camera.fx, "fy": camera.fy, "cx": camera.width, "cy": camera.height, "skew": camera.fx}
    vague = [name for name, scale in limits.items() if sigma[name] > 0.1 * scale]
    if vague:
        raise DegenerateViews(vague, "one standard deviation would exceed a tenth of their size")
    if _tilt_spread(end.state.cam_from_board) < np.radians(15) and _focal_is_loose(end, seen, free, variance):
        raise DegenerateViews(("fx", "fy"), "the views are nearly parallel to each other")
    return known


def _tilt_spread(cam_from_board: SE3) -> float:
    """Largest angle between board normals, mirror-tilts counted apart [rad]."""
    normals = cam_from_board.rotation[:, :, 2]
    mean = normals.mean(axis=0)
    return float(np.arccos(np.clip((normals @ mean / np.linalg.norm(mean)).min(), -1, 1)))


def _focal_is_loose(end: Refinement, seen: Observations, free: Array, variance: float) -> bool:
    """Whether another focal length explains the corners as well: the profile likelihood asked directly.

    Noise bends parallel boards by apparent tilts whose curvature makes the covariance look
    firm where it is not, so the covariance cannot be trusted to tell.
    """
    held = free.copy()
    held[:2] = False
    for factor in (1.15, 1 / 1.15):
        parameters = end.state.camera.parameters
        parameters[:2] *= factor
        pose = end.state.cam_from_board
        farther = SE3(pose.rotation, pose.translation * [1, 1, factor])
        other = State(end.state.camera.with_parameters(parameters), farther, end.state.warp)
        try:
            other = refine(other, seen, held, max_iterations=30, tolerance=0.1)
        except NoConvergence:
            continue
        if 2 * (other.equations.cost - end.equations.cost) < 25 * variance:
            return True
    return False


def _refuse_parallel(cam_from_board: SE3) -> None:
    if _tilt_spread(cam_from_board) < np.radians(10):
        raise DegenerateViews(("fx", "fy", "cx", "cy"), "the views are nearly parallel to each other")
