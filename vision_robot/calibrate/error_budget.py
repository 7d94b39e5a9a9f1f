"""An error budget of the projection: how much of it comes from where, in pixels and in mm.

All lines are root mean square lengths over the picture, after the rotation that suits best
(`Picture`), so they add in squares. Two cameras are compared by

    D^2 = mean |difference|^2,

of which noise alone explains ``tr(M dC)``: of two nested fits to the same corners the
difference has the covariance ``dC = C_richer - C_simpler`` (Hausman 1978), and M turns a
covariance of intrinsics into a mean square over the picture. ``D^2 - tr(M dC)`` is then an
unbiased estimate of the square of what the simpler fit gets wrong. Pixels where the richer fit
itself is not known to five times a corner's noise (far outside all boards) are left out.

The *reference* fit is the simplest one that explains the corners: from the result with the
next richer lens and the next richer board, each is taken back unless it lowers the cost by
more than noise would (F test, |z| > 4, conditional on the other; F is divided by the design
effect, so that errors shared by a whole view do not pass for a lens).

corner noise
    ``sqrt(tr(M C))`` with the result's propagated covariance C, its noise taken from the
    residuals of the reference fit, so that a bent board does not count as noise. Where the
    result estimates the board's shape, C is that for the shape held fixed.
board shape
    ``sqrt(D^2 - tr(M dC))`` between the reference fit with the richer and with the result's
    own board, zero where the richer board is not needed. Where the result estimates a
    shape, the part of ``tr(M C)`` that this costs is added in squares.
lens model
    The same between the next richer lens and the result's own (pinhole, brown5, brown8;
    coefficients that were held fixed set free). A lens with no richer one has no line of its
    own: what it misses shows in the rest.
rest
    ``sqrt(tr(M (C_views - C)))``, where C_views is the covariance that the views' own
    gradients tell (a cluster-robust "sandwich", bias-reduced CR2 of Bell & McCaffrey 2002:
    in expectation equal to C under white noise, and to the bootstrap over views otherwise);
    zero where the excess is below three of its standard deviations.

`at_most_px` bounds each of the last three at 95 %: what could hide in the noise.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vision_robot.calibrate.information import view_information
from vision_robot.calibrate.picture import Picture
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.refine import Refinement, refine, schur_complement
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.calibrate.settings import Settings
from vision_robot.calibrate.solution import solution
from vision_robot.calibrate.state import State
from vision_robot.calibrate.warp import HIGHEST_DEGREE, Warp
from vision_robot.errors import BadParameter, NoConvergence
from vision_robot.geometry import lens_named
from vision_robot.geometry.camera import AFFINE_NAMES
from vision_robot.types import Array, Float

__all__ = ["ErrorBudget", "ErrorLine", "error_budget"]

RICHER_LENS = {"pinhole": "brown5", "brown5": "brown8"}
RICHER_BOARD = 3
"""Degree of the board beside a flat one: bow, twist and an S of either edge; else one more than its own."""

TOLERANCE = 0.03
"""Of a standard deviation, all parameters together: to this part of itself noise is known at best."""

SURE_Z = 4.0
"""Standard deviations by which F must exceed one before a richer fit is believed."""
SURE_REST = 3.0

KNOWN = 5.0
"""Times the noise of a corner: pixels known worse would drown all else in a comparison."""
LEAST_SHARE = 0.3
MANY_VIEWS = 80
"""With more, each pulls so little that a series serves."""
ONE_SIDED_95 = 1.645


@dataclass(frozen=True)
class ErrorLine:
    """One cause; `px` and `mm` its root mean square effect, `at_most_px` what could hide (NaN: unknown)."""

    cause: str
    px: float
    mm: float
    at_most_px: float
    note: str


@dataclass(frozen=True)
class ErrorBudget:
    """Corner noise, board shape, lens model and rest; mm on a plane facing the camera at `distance_m`.

    Rays steeper than 70 degrees do not count in mm.
    """

    noise: ErrorLine
    board: ErrorLine
    lens: ErrorLine
    rest: ErrorLine
    distance_m: float

    @property
    def lines(self) -> tuple[ErrorLine, ErrorLine, ErrorLine, ErrorLine]:
        """All causes."""
        return self.noise, self.board, self.lens, self.rest

    @property
    def total_px(self) -> float:
        """All causes together [px]."""
        return float(np.sqrt(sum(line.px**2 for line in self.lines)))

    @property
    def total_mm(self) -> float:
        """All causes together [mm]."""
        return float(np.sqrt(sum(line.mm**2 for line in self.lines)))

    @property
    def dominant(self) -> ErrorLine:
        """The largest cause."""
        return max(self.lines, key=lambda line: line.px)


def error_budget(
    result: CalibrationResult, board_points: Float[Array, "m 3"], *, distance_m: float | None = None
) -> ErrorBudget:
    """Where the projection error of a calibration comes from.

    Args:
        result: The calibration.
        board_points: Points (m, 3) of its board [m].
        distance_m: Where the plane stands on which mm are stated; the median distance of the
            boards where left out.

    Raises:
        BadParameter: The distance is not positive.
    """
    if distance_m is None:
        distance_m = float(np.median(np.linalg.norm(result.cam_from_board.translation, axis=1)))
    if not (np.isfinite(distance_m) and distance_m > 0):
        raise BadParameter("distance", distance_m, "positive and finite, in metres")
    fits = _Fits(result, np.asarray(board_points, dtype=float))
    reference, needs_lens, needs_board = fits.reference()
    variance = reference.variance
    picture = Picture.of(result.camera)

    own = fits.fit(richer_lens=False, richer_board=False)
    assert own is not None  # the result itself
    size = _Size(picture, distance_m)
    C, held = variance * own.inverse, variance * own.inverse_with_board_held
    noise = _line(
        "corner noise",
        size.of_covariance(held),
        np.nan,
        f"{np.sqrt(variance) * own.typical_sigma:.3g} px a corner and axis",
    )
    estimating = size.of_covariance(C) - size.of_covariance(held)
    board = _compared(
        "board shape",
        fits.fit(richer_lens=needs_lens, richer_board=True),
        fits.fit(richer_lens=needs_lens, richer_board=False),
        _Asked(needs_board, distance_m, reference.design_effect, estimating),
    )
    lens = _compared(
        "lens model",
        fits.fit(richer_lens=True, richer_board=needs_board),
        fits.fit(richer_lens=False, richer_board=needs_board),
        _Asked(needs_lens, distance_m, reference.design_effect),
    )
    return ErrorBudget(noise, board, lens, _rest(reference, distance_m), distance_m)


@dataclass(frozen=True)
class _Fit:
    """A minimum, with what its covariance is made of; `inverse` is in units of the unit variance."""

    end: Refinement
    problem: Problem
    what: str

    @property
    def variance(self) -> float:
        return 2 * self.end.equations.cost / max(self.problem.degrees_of_freedom, 1)

    @property
    def typical_sigma(self) -> float:
        weight = self.problem.seen.weight
        return float(np.median(1 / weight[weight > 0]))

    @property
    def information(self) -> Float[Array, "f f"]:
        return schur_complement(self.end.equations)

    @property
    def inverse(self) -> Float[Array, "p p"]:
        return self.over_camera(_inverse(self.information))

    @property
    def inverse_with_board_held(self) -> Float[Array, "p p"]:
        cameras = int(self.problem.free[: len(self.end.state.camera.parameters)].sum())
        return self.over_camera(_inverse(self.information[:cameras, :cameras]))

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


class _Fits:
    """The result and its richer neighbours, each fitted once."""

    def __init__(self, result: CalibrationResult, board_points: Array):
        self.result, self.board_points = result, board_points
        self.problem = solution(result, board_points)[1]
        self._known: dict[tuple[bool, bool], _Fit | None] = {}

    def reference(self) -> tuple[_Fit, bool, bool]:
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

    def fit(self, *, richer_lens: bool, richer_board: bool) -> _Fit | None:
        """None where there is no such camera or board, or it cannot be fitted."""
        key = (richer_lens, richer_board)
        if key not in self._known:
            self._known[key] = self._fitted(*key)
        return self._known[key]

    def _fitted(self, richer_lens: bool, richer_board: bool) -> _Fit | None:
        result = self.result
        settings = _richer_lens(result.settings) if richer_lens else result.settings
        warp = _richer_board(result, self.board_points) if richer_board else result.warp
        if settings is None or warp is None:
            return None
        known = result.camera.distortion
        more = len(lens_named(settings.model).coefficient_names) - len(known)
        camera = replace(result.camera, model=settings.model, distortion=(*known, *(0.0,) * more))
        problem = _asked(self.problem, settings, warp)
        what = settings.model if richer_lens else ""
        what += (
            f"{' and ' * bool(what)}a board of degree {settings.warp + RICHER_BOARD}" if richer_board else ""
        )
        try:
            start = State(camera, result.cam_from_board, warp)
            return _Fit(refine(start, problem, tolerance=TOLERANCE), problem, what)
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


def _better(richer: _Fit, simpler: _Fit | None) -> bool:
    """Whether noise does not explain by how much the richer fit lowers the cost."""
    if simpler is None:
        return False
    more = int(richer.problem.free.sum() - simpler.problem.free.sum())
    dof = max(richer.problem.degrees_of_freedom, 1)
    gained = 2 * (simpler.end.equations.cost - richer.end.equations.cost)
    ratio = gained / more / (richer.variance * richer.design_effect)
    return bool((ratio - 1) / np.sqrt(2 / more + 2 / dof) > SURE_Z)


@dataclass(frozen=True)
class _Size:
    """Mean squares over the picture: (px^2, mm^2)."""

    picture: Picture
    distance_m: float

    def of_covariance(self, covariance: Array) -> Float[Array, "2"]:
        px, m = self.picture.weight(), self.picture.weight(self.distance_m)
        return np.array([np.sum(px * covariance), 1e6 * np.sum(m * covariance)])

    def spectrum(self, covariance: Array) -> Float[Array, "2 p"]:
        """Weights of the squared unit normals whose sum the mean square is; rounding below zero cut off."""
        values = []
        for weight in (self.picture.weight(), 1e6 * self.picture.weight(self.distance_m)):
            length, axes = np.linalg.eigh(weight)
            root = axes * np.sqrt(np.maximum(length, 0))
            values.append(np.maximum(np.linalg.eigvalsh(root.T @ covariance @ root), 0))
        return np.array(values)

    def of_displacements(self, moved: Float[Array, "n 2"]) -> Float[Array, "2"]:
        px, m = self.picture.mean_square(moved), self.picture.mean_square(moved, self.distance_m)
        return np.array([px, 1e6 * m])


@dataclass(frozen=True)
class _Asked:
    """What a comparison is asked: whether the richer fit is needed, where, and what comes on top."""

    needed: bool
    distance_m: float
    design_effect: float
    besides: Float[Array, "2"] | float = 0.0


def _compared(cause: str, richer: _Fit | None, simpler: _Fit | None, asked: _Asked) -> ErrorLine:
    """The difference of two nested fits beyond what noise explains."""
    besides = np.maximum(np.zeros(2) + asked.besides, 0)
    if richer is None or simpler is None:
        return _line(cause, besides, np.nan, "nothing richer to compare with: what it misses is in the rest")
    picture, share = richer.picture
    if picture is None:
        return _line(cause, besides, np.nan, f"{richer.what} is hardly determined by these views")
    size = _Size(picture, asked.distance_m)
    found = size.of_displacements(picture.difference(simpler.end.state.camera))
    more = _embedded(simpler.inverse, len(richer.inverse))
    dC = richer.variance * asked.design_effect * (richer.inverse - more)
    by_noise = size.spectrum(dC)
    beyond = np.maximum(found - by_noise.sum(axis=1), 0)
    # Standard deviation of a quadratic form in normal numbers about a mean of square `beyond`.
    spread = np.sqrt(2 * np.sum(by_noise[0] ** 2) + 4 * beyond[0] * by_noise[0].max())
    at_most = float(np.sqrt(besides[0] + beyond[0] + ONE_SIDED_95 * spread))
    if not asked.needed:
        return _line(
            cause, besides, at_most, f"{richer.what} explains the corners no better than noise would"
        )
    note = f"{richer.what} is needed: the camera then moves by {np.sqrt(found[0]):.2g} px"
    note += "" if share > 0.99 else f" over the {100 * share:.0f} % of the picture where it is known"
    return _line(cause, besides + beyond, at_most, note)


def _rest(fit: _Fit, distance_m: float) -> ErrorLine:
    """What the views disagree by, beyond white noise."""
    variance = fit.variance
    each, between = fit.sandwich
    picture, _ = fit.picture
    if picture is None:
        return _line("rest", np.zeros(2), np.nan, "the camera is hardly determined by these views")
    size = _Size(picture, distance_m)
    excess = size.of_covariance(fit.over_camera(between)) - size.of_covariance(variance * fit.inverse)
    inverse = _inverse(fit.information)
    free = np.flatnonzero(fit.problem.free[: len(picture.camera.parameters)])
    M = np.zeros_like(inverse)
    M[: len(free), : len(free)] = picture.weight()[np.ix_(free, free)]
    AS = inverse @ M @ inverse @ each
    spread = variance * np.sqrt(2 * np.einsum("vij,vji->", AS, AS))
    at_most = float(np.sqrt(max(excess[0], 0) + ONE_SIDED_95 * spread))
    if excess[0] <= SURE_REST * spread:
        return _line("rest", np.zeros(2), at_most, "the views agree as noise lets them")
    factor = np.sqrt(1 + excess[0] / size.of_covariance(variance * fit.inverse)[0])
    note = f"the views disagree {factor:.2g} times as much as noise lets them: errors are shared within views"
    return _line("rest", np.maximum(excess, 0), at_most, note)


def _inverse(S: Float[Array, "f f"]) -> Float[Array, "f f"]:
    scale = 1 / np.sqrt(np.diag(S))
    return np.linalg.pinv(S * scale[:, None] * scale, rcond=1e-14, hermitian=True) * scale[:, None] * scale


def _embedded(matrix: Float[Array, "k k"], size: int) -> Float[Array, "p p"]:
    full = np.zeros((size, size))
    full[: len(matrix), : len(matrix)] = matrix
    return full


def _line(cause: str, squares: Float[Array, "2"], at_most_px: float, note: str) -> ErrorLine:
    px, mm = np.sqrt(np.maximum(squares, 0))
    return ErrorLine(cause, float(px), float(mm), at_most_px, note)
