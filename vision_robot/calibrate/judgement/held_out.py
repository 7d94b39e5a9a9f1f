"""The error of a camera on views it was not fitted to.

A held-out view says nothing about its own pose, so the pose is fitted to it and nothing
else. That takes six of its 2n measured numbers, and under a right camera the sum of
squares left has the mean ``s^2 (2n - 6)`` where corners scatter with s per axis. Hence

    rms of view v = sqrt(2 sum |e|^2 / (2 n_v - 6))

is a length per point, both axes together, in pixels, that noise alone brings to sqrt(2) s
whatever the number of parameters; what a camera took for signal and was noise, or a camera
too simple for its lens, makes it larger.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.judgement.solution import solution
from vision_robot.calibrate.judgement.view_blocks import ViewBlocks
from vision_robot.calibrate.normal_equations import residuals
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.refine import refine
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.calibrate.settings import Settings
from vision_robot.calibrate.solve import calibrate
from vision_robot.calibrate.start import poses_from_bearings
from vision_robot.calibrate.state import State
from vision_robot.calibrate.warp import Warp
from vision_robot.calibrate.weighting import trust
from vision_robot.errors import BadParameter, NoConvergence, TooFewViews
from vision_robot.geometry import Camera
from vision_robot.types import Array, Float

__all__ = ["HeldOut", "cross_validate", "held_out", "hold_back"]

FEWEST_LEFT = 3
"""Views that must be left to calibrate from."""

TINY_PX = 1e-9
"""Rounding: two cameras that leave no more than that are alike."""

SETTLED = 0.1
"""Standard deviations that a fold's camera may lie off its minimum: a hundredth of one parameter's price."""


@dataclass(frozen=True)
class HeldOut:
    """Errors on views that the camera was not fitted to.

    `view_rms_px` (views,) per point, both axes together, corrected for the pose; infinite
    where no pose brings the board before the camera. `freedom` (views,) = 2n - 6.
    """

    images: tuple[str, ...]
    view_rms_px: Float[Array, "views"]
    freedom: Float[Array, "views"]
    folds: int = 1

    @property
    def rms_px(self) -> float:
        """Over all views together [px]."""
        return float(np.sqrt(np.average(self.view_rms_px**2, weights=self.freedom)))

    @property
    def standard_error_px(self) -> float:
        """Of `rms_px`, from the scatter between views [px]."""
        _, error = _mean_and_error(self.view_rms_px**2, self.freedom)
        return error / (2 * max(self.rms_px, 1e-300))

    def worse_by(self, other: "HeldOut") -> tuple[float, float]:
        """By which part a view's error exceeds another camera's, mean over views, and its standard error.

        The logarithm of the ratio of rms, so that what makes a view hard for both cancels and
        no single view can drown the others. Raises BadParameter where the views differ.
        """
        if self.images != other.images or not np.array_equal(self.freedom, other.freedom):
            raise BadParameter("held-out views", len(self.images), "the same as those compared with")
        return _mean_and_error(
            np.log((self.view_rms_px + TINY_PX) / (other.view_rms_px + TINY_PX)), self.freedom
        )


def held_out(
    camera: Camera, corners: Sequence[Corners], board_points: Float[Array, "m 3"], warp: Warp | None = None
) -> HeldOut:
    """How well a camera (and the board's warp) explains views it has not met; at least 4 corners each.

    Args:
        camera: The camera, not changed.
        corners: The views.
        board_points: Board points (m, 3) [m] in the board frame, z = 0.
        warp: The board's departure from its drawing, not changed; none where left out.
    """
    warp = warp or Warp.none(len(board_points))
    seen = Observations.of(corners, board_points)
    few = [view for view in corners if len(view) < 4]
    if few:
        raise BadParameter(
            f"corners of {few[0].image}", len(few[0]), "four or more, to find a pose and judge it"
        )
    start = State(camera, poses_from_bearings(camera, seen), warp)
    if np.ptp(seen.sigma_px[seen.present]) > 1e-9:
        # How far the detector's word is trusted shows in equally weighted residuals first.
        equal = seen.with_weight(seen.present.astype(float))
        lengths = np.linalg.norm(_pose_residuals(start, equal), axis=1)[seen.present]
        if np.isfinite(lengths).all():
            sigma = trust(lengths, seen.sigma_px[seen.present]).sigma(seen.sigma_px)
            seen = seen.with_weight(np.where(seen.present, 1 / sigma, 0.0))
    return _judged(start, seen, tuple(view.image for view in corners))


def cross_validate(
    corners: Sequence[Corners],
    board_points: Float[Array, "m 3"],
    size: tuple[int, int],
    settings: Settings | None = None,
    *,
    folds: int = 10,
    seed: int = 0,
) -> HeldOut:
    """Error on views held out, each once, from calibrations of the others.

    Args:
        corners: One entry for each picture in which the board was found.
        board_points: Board points (m, 3) [m] in the board frame, z = 0.
        size: Width and height of the pictures [px].
        settings: Which camera is fitted, and how; `Settings()` where left out.
        folds: Into how many parts the views are split; as many as views leaves out one at a time.
        seed: Which split.

    Raises what `calibrate` raises; TooFewViews below four; NoConvergence where a fold does not settle.
    """
    return hold_back(calibrate(corners, board_points, size, settings), board_points, folds=folds, seed=seed)


def hold_back(
    result: CalibrationResult, board_points: Float[Array, "m 3"], *, folds: int = 10, seed: int = 0
) -> HeldOut:
    """The same from a calibration that is done: of its own corners, each fold started from it."""
    views = len(result.corners)
    if views <= FEWEST_LEFT:
        raise TooFewViews(views, FEWEST_LEFT + 1, views)
    if folds < 2:
        raise BadParameter("folds", folds, "two or more")
    blocks = ViewBlocks.of(*solution(result, board_points))
    fold = _split(views, folds, seed)
    weights = (fold != np.arange(fold.max() + 1)[:, None]).astype(float)
    steps = blocks.steps(weights)
    if not np.isfinite(steps).all():
        raise NoConvergence("with some of the views held out, the others leave parameters undetermined")
    parts = []
    for weight, step in zip(weights, steps, strict=True):
        fitted = blocks.refitted(weight, step, tolerance=SETTLED).state
        out = np.flatnonzero(weight == 0)
        images = tuple(result.corners[i].image for i in out)
        start = State(fitted.camera, result.cam_from_board[out], fitted.warp)
        parts.append((out, _judged(start, blocks.problem.seen[out], images)))
    order = np.argsort(np.concatenate([out for out, _ in parts]))
    together = {
        name: np.concatenate([getattr(part, name) for _, part in parts])[order]
        for name in ("view_rms_px", "freedom")
    }
    return HeldOut(tuple(view.image for view in result.corners), folds=len(weights), **together)


def _split(views: int, folds: int, seed: int) -> Array:
    """A fold for each view, of sizes that differ by one at most and leave enough views."""
    folds = min(folds, views)
    while views - -(-views // folds) < FEWEST_LEFT:
        folds += 1
    return np.random.default_rng(seed).permutation(np.arange(views) % folds)


def _judged(start: State, seen: Observations, images: tuple[str, ...]) -> HeldOut:
    """Camera and warp of a state on views, their poses refined from those of the state."""
    square = np.sum(_pose_residuals(start, seen) ** 2, axis=(1, 2))
    freedom = 2.0 * seen.present.sum(axis=1) - 6
    return HeldOut(images, np.sqrt(2 * square / freedom), freedom)


def _pose_residuals(start: State, seen: Observations) -> Float[Array, "views 2 n"]:
    """Residuals [px] at the best pose of each view; infinite where there is none."""
    problem = Problem.plain(seen, np.zeros(len(start.shared_parameters), dtype=bool))
    with np.errstate(invalid="ignore", over="ignore"):  # a hopeless pose is damped without end
        try:
            return residuals(refine(start, problem, tolerance=0.01).state, seen)
        except NoConvergence:
            pass
    if seen.views == 1:
        return np.repeat(np.where(seen.present[:, None], np.inf, 0.0), 2, axis=1)
    # One view that has no pose must not spoil the others.
    each = []
    for i in range(seen.views):
        one = slice(i, i + 1)
        each.append(_pose_residuals(State(start.camera, start.cam_from_board[one], start.warp), seen[one]))
    return np.concatenate(each)


def _mean_and_error(values: Float[Array, "n"], weights: Float[Array, "n"]) -> tuple[float, float]:
    """Weighted mean and its standard error from the scatter of the values."""
    share = weights / weights.sum()
    mean = float(share @ values)
    if len(values) < 2 or not np.isfinite(mean):
        return mean, np.inf
    n = len(values)
    return mean, float(np.sqrt(np.sum((share * (values - mean)) ** 2) * n / (n - 1)))
