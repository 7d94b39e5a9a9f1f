"""Which lens and how bent a board: the simplest that explains views it was not fitted to.

More parameters always fit better, so the rms tells nothing. Held-out views do: a parameter
that follows noise makes them worse. The best candidate is best by chance as well, so that
the simplest one is taken that is worse by no more than one standard error of the paired
difference over views (the one-standard-error rule of Breiman et al. 1984, section 3.4.3), or
by less than its missing parameters must earn.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.judgement.held_out import HeldOut, hold_back
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.calibrate.settings import Settings
from vision_robot.calibrate.solve import calibrate
from vision_robot.calibrate.warp import HIGHEST_DEGREE, Warp
from vision_robot.errors import BadParameter, DegenerateViews, NoConvergence
from vision_robot.geometry import LENSES
from vision_robot.types import Array, Float

__all__ = ["Selection", "every_candidate", "select"]

COUNTED = {"fisheye": 6}
"""Its four coefficients count as more than brown5's five: a lens that both explain is no fisheye."""

FIRST_DEGREE = 2
"""Lenses meet over a board that may bend a little, lest a bent board be taken for a lens."""

PRICE = 1.5
"""What a further parameter must lower the held-out rms by, as a part of it, times the measured numbers:
three times what it raises it by if it is needless. Less than that is chance, however steady over views."""

AHEAD = 2
"""Degrees of the warp tried past the one chosen so far: one that adds nothing may hide one that does."""

HOPELESS = 1.5
"""A lens whose held-out error there is so many times the best one's is not tried further."""

NEARLY = 1.05
"""A lens whose held-out error is so many times the chosen one's there is followed to other degrees too."""

MOSTLY = 0.9
"""Share of the corners that a fit must keep for its choice of outliers to be believed."""


@dataclass(frozen=True)
class Selection:
    """The candidates tried, from the simplest on, and which was chosen.

    A row each: `settings`, how many `parameters` it estimates besides poses, `rms_px` on
    the corners it was fitted to, `held_out_px` on those it was not (`HeldOut.rms_px`), by
    which part of it the error of a view `exceeds` the best candidate's (mean over views)
    with its `standard_error`, and `why`. Not a number where a candidate failed.
    """

    settings: tuple[Settings, ...]
    parameters: tuple[int, ...]
    rms_px: Float[Array, "n"]
    held_out_px: Float[Array, "n"]
    exceeds: Float[Array, "n"]
    standard_error: Float[Array, "n"]
    why: tuple[str, ...]
    chosen_index: int
    best_index: int

    @property
    def chosen(self) -> Settings:
        """The settings to calibrate with."""
        return self.settings[self.chosen_index]


def every_candidate(degrees: Sequence[int] = range(HIGHEST_DEGREE + 1)) -> tuple[Settings, ...]:
    """Each lens model with each degree of the board's warp."""
    return tuple(Settings(model=model, warp=degree) for model in LENSES for degree in degrees)


def select(
    corners: Sequence[Corners],
    board_points: Float[Array, "m 3"],
    size: tuple[int, int],
    candidates: Sequence[Settings] | None = None,
    *,
    folds: int = 10,
    seed: int = 0,
    exhaustive: bool = False,
) -> Selection:
    """Choose among candidates by cross-validation over views.

    Args:
        corners: One entry for each picture in which the board was found.
        board_points: Board points (m, 3) [m] in the board frame, z = 0.
        size: Width and height of the pictures [px].
        candidates: Settings to choose from; `every_candidate()` where left out.
        folds: See `cross_validate`.
        seed: Which split into folds; the same for all candidates.
        exhaustive: Whether all are tried. Otherwise one of each lens is, then the warps of the
            lens that is chosen among those and of simpler ones, up to two degrees past the
            best, then the other lenses with that warp.

    Outliers are left out once, by the candidate that explains the corners best, so that all
    are judged on the same corners. Raises TooFewViews below four views, DegenerateViews or
    NoConvergence when no candidate works.
    """
    candidates = every_candidate() if candidates is None else tuple(candidates)
    if not candidates:
        raise BadParameter("candidates", 0, "one or more settings")
    settings = sorted(candidates, key=lambda settings: _simplicity(settings, board_points))
    trials = _Trials(settings, board_points)
    first = _one_for_each_lens(settings)
    corners, fits = _without_outliers(corners, board_points, size, [settings[i] for i in first])

    def attempt(chosen: Sequence[int]) -> None:
        for i in chosen:
            if i in trials.outcome:
                continue
            try:
                result = fits.get(settings[i].model) if i in first else None
                with np.errstate(all="ignore"):  # a hopeless candidate may overflow on its way
                    if result is None:
                        result = calibrate(corners, board_points, size, replace(settings[i], robust=False))
                    trials.add(i, result, hold_back(result, board_points, folds=folds, seed=seed))
            except (DegenerateViews, NoConvergence) as error:
                trials.outcome[i] = str(error)

    attempt(first)
    if exhaustive:
        attempt(range(len(settings)))
    else:
        degree, lenses = None, trials.promising()
        while degree != settings[trials.choice()].warp:
            degree = settings[trials.choice()].warp
            attempt(
                [i for i, one in enumerate(settings) if one.model in lenses and one.warp <= degree + AHEAD]
            )
        attempt(
            [i for i, one in enumerate(settings) if one.warp == degree and not trials.hopeless(one.model)]
        )
    return trials.selection()


@dataclass(frozen=True)
class _Trials:
    """Candidates from the simplest on, and what came of those tried: errors, or a reason."""

    settings: Sequence[Settings]
    board_points: Float[Array, "m 3"]
    outcome: dict[int, HeldOut | str] = field(default_factory=dict)
    rms_px: dict[int, float] = field(default_factory=dict)

    def add(self, index: int, result: CalibrationResult, error: HeldOut) -> None:
        """Note a candidate's errors; without a pose for some view it has none."""
        self.rms_px[index] = result.rms_px
        lost = [
            image for image, rms in zip(error.images, error.view_rms_px, strict=True) if not np.isfinite(rms)
        ]
        self.outcome[index] = f"fitted to the others, it has no pose for {lost[0]}" if lost else error

    def done(self) -> dict[int, HeldOut]:
        """Those with errors; raises NoConvergence where there is none."""
        done = {i: outcome for i, outcome in self.outcome.items() if isinstance(outcome, HeldOut)}
        if not done:
            reason = next(iter(self.outcome.values()))
            raise NoConvergence(f"no candidate could be calibrated; the simplest failed so: {reason}")
        return done

    def best(self) -> int:
        """The one with the least held-out error, as a mean over views."""
        done = self.done()
        reference = next(iter(done.values()))
        return min(done, key=lambda i: done[i].worse_by(reference)[0])

    def near(self) -> list[int]:
        """The best and all about as good, the simplest first."""
        done, best = self.done(), self.best()
        price = PRICE / done[best].freedom.sum()
        counted = [_simplicity(settings, self.board_points)[0] for settings in self.settings]
        near = []
        for i, error in done.items():
            mean, scatter = error.worse_by(done[best])
            if i == best or mean <= max(scatter, price * (counted[best] - counted[i])):
                near.append(i)
        return sorted(near)

    def choice(self) -> int:
        """The simplest of those."""
        return self.near()[0]

    def promising(self) -> set[str]:
        """The lens chosen so far, and simpler ones nearly as good: a richer one may fail on the way."""
        done, choice = self.done(), self.choice()
        limit = NEARLY * done[choice].rms_px
        return {self.settings[i].model for i, e in done.items() if i <= choice and e.rms_px <= limit}

    def hopeless(self, lens: str) -> bool:
        """Whether the lens failed or stayed far behind wherever it was tried."""
        done = self.done()
        least = min(error.rms_px for error in done.values())
        mine = [error.rms_px for i, error in done.items() if self.settings[i].model == lens]
        return min(mine, default=np.inf) > HOPELESS * least

    def selection(self) -> Selection:
        """The table of those tried, and the choice with its reasons."""
        done, best, near = self.done(), self.best(), self.near()
        tried = sorted(self.outcome)
        rms, out, exceeds, scatter = (np.full(len(tried), np.nan) for _ in range(4))
        why = []
        for row, i in enumerate(tried):
            outcome = self.outcome[i]
            rms[row] = self.rms_px.get(i, np.nan)
            if isinstance(outcome, str):
                why.append(outcome)
                continue
            out[row] = outcome.rms_px
            exceeds[row], scatter[row] = outcome.worse_by(done[best])
            if i == near[0]:
                why.append("the best" if i == best else "the simplest one about as good as the best")
            elif i in near:
                why.append("no simpler than the chosen one, and better by chance at most")
            else:
                why.append(f"{exceeds[row] / scatter[row]:.1f} standard errors behind the best")
        settings = tuple(self.settings[i] for i in tried)
        parameters = tuple(_parameters(one, self.board_points) for one in settings)
        chosen, best = tried.index(near[0]), tried.index(best)
        return Selection(settings, parameters, rms, out, exceeds, scatter, tuple(why), chosen, best)


def _parameters(settings: Settings, board_points: Array) -> int:
    return int(settings.free.sum()) + len(Warp.smooth(board_points, settings.warp))


def _simplicity(settings: Settings, board_points: Array) -> tuple[int, int]:
    own = len(LENSES[settings.model].coefficient_names)
    counted = _parameters(settings, board_points) - own + COUNTED.get(settings.model, own)
    return counted, list(LENSES).index(settings.model)


def _one_for_each_lens(candidates: Sequence[Settings]) -> list[int]:
    """For each lens the candidate with the warp nearest the first degree."""
    first: dict[str, int] = {}
    for i, settings in enumerate(candidates):
        held = first.get(settings.model)
        if held is None or abs(settings.warp - FIRST_DEGREE) < abs(candidates[held].warp - FIRST_DEGREE):
            first[settings.model] = i
    return list(first.values())


def _without_outliers(
    corners: Sequence[Corners],
    board_points: Array,
    size: tuple[int, int],
    candidates: Sequence[Settings],
) -> tuple[tuple[Corners, ...], dict[str, CalibrationResult]]:
    """The corners that the best of some robust fits keeps, and by lens the fits that keep the same ones."""
    fits, failure = [], None
    for settings in candidates:
        try:
            with np.errstate(all="ignore"):
                fits.append(calibrate(corners, board_points, size, replace(settings, robust=True)))
        except (DegenerateViews, NoConvergence) as error:
            failure = error
    if not fits:
        raise failure or NoConvergence("no candidate could be calibrated")
    most = max(fit.corner_count for fit in fits)
    best = min((fit for fit in fits if fit.corner_count >= MOSTLY * most), key=lambda fit: fit.noise_px)
    same = [fit for fit in fits if len(fit.rejected) == len(best.rejected) == 0 or fit is best]
    return best.corners, {fit.settings.model: fit for fit in same}
