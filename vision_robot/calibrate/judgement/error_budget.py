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

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.judgement.nested_fits import Fit, NestedFits, inverted
from vision_robot.calibrate.judgement.picture import Picture
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float

__all__ = ["ErrorBudget", "ErrorLine", "error_budget"]

SURE_REST = 3.0
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
    fits = NestedFits(result, np.asarray(board_points, dtype=float))
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


def _compared(cause: str, richer: Fit | None, simpler: Fit | None, asked: _Asked) -> ErrorLine:
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


def _rest(fit: Fit, distance_m: float) -> ErrorLine:
    """What the views disagree by, beyond white noise."""
    variance = fit.variance
    each, between = fit.sandwich
    picture, _ = fit.picture
    if picture is None:
        return _line("rest", np.zeros(2), np.nan, "the camera is hardly determined by these views")
    size = _Size(picture, distance_m)
    excess = size.of_covariance(fit.over_camera(between)) - size.of_covariance(variance * fit.inverse)
    inverse = inverted(fit.information)
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


def _embedded(matrix: Float[Array, "k k"], size: int) -> Float[Array, "p p"]:
    full = np.zeros((size, size))
    full[: len(matrix), : len(matrix)] = matrix
    return full


def _line(cause: str, squares: Float[Array, "2"], at_most_px: float, note: str) -> ErrorLine:
    px, mm = np.sqrt(np.maximum(squares, 0))
    return ErrorLine(cause, float(px), float(mm), at_most_px, note)
