"""A calibration beside its richer neighbours: the same corners, a richer lens, a board less flat."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vision_robot.calibrate.judgement.information import view_information
from vision_robot.calibrate.judgement.picture import Picture
from vision_robot.calibrate.judgement.solution import solution
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.refine import Refinement, refine, schur_complement
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.calibrate.settings import Settings
from vision_robot.calibrate.state import State
from vision_robot.calibrate.warp import HIGHEST_DEGREE, Warp
from vision_robot.errors import BadParameter, NoConvergence
from vision_robot.geometry import lens_named
from vision_robot.geometry.camera import AFFINE_NAMES
from vision_robot.types import Array, Float

__all__ = ["Fit", "NestedFits", "inverted"]

RICHER_LENS = {"pinhole": "brown5", "brown5": "brown8"}
RICHER_BOARD = 3
"""Degree of the board beside a flat one: bow, twist and an S of either edge; else one more than its own."""

TOLERANCE = 0.03
"""Of a standard deviation, all parameters together: to this part of itself noise is known at best."""

SURE_Z = 4.0
"""Standard deviations by which F must exceed one before a richer fit is believed."""

MANY_VIEWS = 80
"""With more, each pulls so little that a series serves."""

KNOWN = 5.0
"""Times the noise of a corner: pixels known worse would drown all else in a comparison."""
LEAST_SHARE = 0.3


@dataclass(frozen=True)
class Fit:
    """A minimum, with what its covariance is made of; `what` names it in words.

    `inverse` is in units of the variance of unit weight.
    """

    end: Refinement
    problem: Problem
    what: str

    @property
    def variance(self) -> float:
        """Variance of unit weight that the residuals tell."""
        return 2 * self.end.equations.cost / max(self.problem.degrees_of_freedom, 1)

    @property
    def typical_sigma(self) -> float:
        """Median stated sigma of a corner [px]."""
        weight = self.problem.seen.weight
        return float(np.median(1 / weight[weight > 0]))

    @property
    def information(self) -> Float[Array, "f f"]:
        """Schur complement over the free shared parameters."""
        return schur_complement(self.end.equations)

    @property
    def inverse(self) -> Float[Array, "p p"]:
        """Of the information, the camera's part."""
        return self.over_camera(inverted(self.information))

    @property
    def inverse_with_board_held(self) -> Float[Array, "p p"]:
        """The same had the board's shape been known."""
        cameras = int(self.problem.free[: len(self.end.state.camera.parameters)].sum())
        return self.over_camera(inverted(self.information[:cameras, :cameras]))

    @property
    def design_effect(self) -> float:
        """Variance of the estimates that the views tell, over that of white noise; mean over parameters."""
        _, between = self.sandwich
        return max(1.0, float(np.trace(self.information @ between)) / (self.variance * len(between)))

    @cached_property
    def picture(self) -> tuple[Picture | None, float]:
        """The part of the picture where this camera is known well enough to be compared; how large it is."""
        whole = Picture.of(self.end.state.camera)
        C, limit = self.variance * self.inverse, self.variance * (KNOWN * self.typical_sigma) ** 2
        squares = whole.variance(C)
        for _ in range(4):  # the wildest pixels must not choose the rotation for the others
            part = squares < max(limit, np.quantile(squares, LEAST_SHARE))
            squares = whole.turned_on(part).variance(C)
        known: Array = np.less(squares, limit)
        share = float(np.mean(known))
        return (whole.where(known) if share > LEAST_SHARE else None), share

    @cached_property
    def sandwich(self) -> tuple[Float[Array, "views f f"], Float[Array, "f f"]]:
        """Each view's information, and the covariance of the estimate that the views' gradients tell (CR2).

        A view's gradient has, after the fit, the covariance ``s^2 (S_v - S_v S^-1 S_v)`` instead
        of ``s^2 S_v``: it is small since the view has pulled the estimate to itself. Where S is
        the identity and S_v is Q, multiplying by ``(1 - Q)^-1/2`` undoes that.
        """
        each, gradient = view_information(self.end.state, self.problem.seen, self.problem.free)
        S = self.information
        scale = 1 / np.sqrt(np.diag(S))
        values, vectors = np.linalg.eigh(S * scale[:, None] * scale)
        # whiten^T S whiten = 1
        whiten = scale[:, None] * vectors / np.sqrt(np.maximum(values, 1e-14 * values[-1]))
        Q, g = whiten.T @ each @ whiten, gradient @ whiten
        if len(Q) > MANY_VIEWS:
            half = np.einsum("vij,vj->vi", Q, g) / 2
            g = g + half + 0.75 * np.einsum("vij,vj->vi", Q, half)  # the series of (1 - Q)^-1/2
        else:
            share, basis = np.linalg.eigh(Q)
            inside = np.einsum("vfk,vf->vk", basis, g) / np.sqrt(np.clip(1 - share, 0.02, 1))
            g = np.einsum("vfk,vk->vf", basis, inside)
        moved = g @ whiten.T
        return each, moved.T @ moved

    def over_camera(self, inverse: Float[Array, "f f"]) -> Float[Array, "p p"]:
        """The camera's part of a matrix over free shared parameters, zeros where fixed."""
        count = len(self.end.state.camera.parameters)
        free = np.flatnonzero(self.problem.free[:count])
        full = np.zeros((count, count))
        full[np.ix_(free, free)] = inverse[: len(free), : len(free)]
        return full


class NestedFits:
    """The result and its richer neighbours, each fitted once."""

    def __init__(self, result: CalibrationResult, board_points: Array):
        self.result, self.board_points = result, board_points
        self.problem = solution(result, board_points)[1]
        self._known: dict[tuple[bool, bool], Fit | None] = {}

    def reference(self) -> tuple[Fit, bool, bool]:
        """The simplest fit that explains the corners; whether it has the richer lens, the richer board."""
        lenses = self.fit(richer_lens=True, richer_board=False) is not None
        boards = self.fit(richer_lens=False, richer_board=True) is not None
        if lenses and boards and self.fit(richer_lens=True, richer_board=True) is None:
            lenses = False
        full = self.fit(richer_lens=lenses, richer_board=boards)
        assert full is not None
        needs_lens = lenses and _better(full, self.fit(richer_lens=False, richer_board=boards))
        needs_board = boards and _better(full, self.fit(richer_lens=lenses, richer_board=False))
        reference = self.fit(richer_lens=needs_lens, richer_board=needs_board)
        assert reference is not None
        return reference, needs_lens, needs_board

    def fit(self, *, richer_lens: bool, richer_board: bool) -> Fit | None:
        """None where there is no such camera or board, or it cannot be fitted."""
        key = (richer_lens, richer_board)
        if key not in self._known:
            self._known[key] = self._fitted(*key)
        return self._known[key]

    def _fitted(self, richer_lens: bool, richer_board: bool) -> Fit | None:
        result = self.result
        settings = _richer_lens(result.settings) if richer_lens else result.settings
        warp = _richer_board(result, self.board_points) if richer_board else result.warp
        if settings is None or warp is None:
            return None
        known = result.camera.distortion
        more = len(lens_named(settings.model).coefficient_names) - len(known)
        camera = replace(result.camera, model=settings.model, distortion=(*known, *(0.0,) * more))
        problem = _asked(self.problem, settings, warp)
        richer = [settings.model] * richer_lens + [f"a board of {len(warp)} coefficients"] * richer_board
        what = " with ".join(richer)
        try:
            start = State(camera, result.cam_from_board, warp)
            return Fit(refine(start, problem, tolerance=TOLERANCE), problem, what)
        except (NoConvergence, np.linalg.LinAlgError):
            return None


def _asked(problem: Problem, settings: Settings, warp: Warp) -> Problem:
    """The same corners and priors asked for another camera or board; a richer lens only adds names."""
    free = np.concatenate([settings.free, np.ones(len(warp), dtype=bool)])
    asked = Problem.plain(problem.seen, free)
    for i, name in enumerate(settings.names):
        if name in settings.priors:
            asked.prior_mean[i] = problem.prior_mean[i]
            asked.prior_information[i] = problem.prior_information[i]
    return asked


def _richer_lens(settings: Settings) -> Settings | None:
    """All coefficients of the lens free, or the next model where they are."""
    held = {name: value for name, value in settings.fixed.items() if name in AFFINE_NAMES}
    if len(held) < len(settings.fixed):
        return replace(settings, fixed=held)
    model = RICHER_LENS.get(settings.model)
    return None if model is None else replace(settings, model=model)


def _richer_board(result: CalibrationResult, points: Array) -> Warp | None:
    own = result.settings.warp
    for degree in range(min(max(RICHER_BOARD, own + 1), HIGHEST_DEGREE), own, -1):
        try:
            return Warp.smooth(points, degree)
        except BadParameter:
            continue
    return None


def _better(richer: Fit, simpler: Fit | None) -> bool:
    """Whether noise does not explain by how much the richer fit lowers the cost."""
    if simpler is None:
        return False
    more = int(richer.problem.free.sum() - simpler.problem.free.sum())
    dof = max(richer.problem.degrees_of_freedom, 1)
    gained = 2 * (simpler.end.equations.cost - richer.end.equations.cost)
    ratio = gained / more / (richer.variance * richer.design_effect)
    return bool((ratio - 1) / np.sqrt(2 / more + 2 / dof) > SURE_Z)


def inverted(S: Float[Array, "f f"]) -> Float[Array, "f f"]:
    """Inverse of an information whose units differ; nothing along directions lost to rounding."""
    scale = 1 / np.sqrt(np.diag(S))
    return np.linalg.pinv(S * scale[:, None] * scale, rcond=1e-14, hermitian=True) * scale[:, None] * scale
