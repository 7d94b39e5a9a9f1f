"""The error budget of a grasp: what each stage cost, what it was foretold to cost, whether the two agree."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.evaluate.attribution import Attribution, attribute, subsets
from vision_robot.evaluate.statistics import Interval, clustered_interval
from vision_robot.pick.budget import Counterfactuals
from vision_robot.pick.knowledge import STAGES
from vision_robot.pick.moments import Moments
from vision_robot.types import Array, Float

__all__ = ["AGREES_WITHIN", "ErrorBudget", "error_budget"]

AGREES_WITHIN = 0.2
"""Share by which a measured root mean square may differ from the foretold one."""

NEGLIGIBLE = 0.05
"""Of the total: a stage that costs less, measured and foretold, is right whatever it says."""

Verdict = Literal["agrees", "more", "less", "open"]


@dataclass(frozen=True)
class ErrorBudget:
    """Position of the tool against the thing at closing, root mean square over seeds, and its parts."""

    seeds: tuple[int, ...]
    measured: Moments
    predicted: Moments
    """Mean over the same seeds of what was foretold for each, from the covariances alone."""
    shares: Attribution
    """Of the measured rms [m]: Shapley values, which add up."""
    predicted_shares: Attribution
    total_m: Interval
    """Measured rms, with the interval that so many seeds leave."""
    alone_m: Mapping[str, Interval]
    """Measured rms of each stage when all others are the truth."""
    yaw_rad: Interval

    @property
    def predicted_m(self) -> float:
        """Foretold rms."""
        return self.predicted.rms_m()

    @property
    def ratio(self) -> Interval:
        """Measured over foretold rms."""
        return _over(self.total_m, self.predicted_m)

    def verdict(self, stage: str | None = None) -> Verdict:
        """Whether a stage, or the whole, cost what was foretold; open where the seeds cannot tell.

        `more` means a covariance that is too small or an error that is in none of them, such as a fault.
        """
        if stage is None:
            ratio = self.ratio
        else:
            foretold, cost = self.predicted.alone_m(stage), self.alone_m[stage]
            if max(foretold, cost.value) < NEGLIGIBLE * max(self.total_m.value, self.predicted_m):
                return "agrees"
            ratio = _over(cost, foretold)
        if abs(ratio.value - 1) <= AGREES_WITHIN:
            return "agrees"
        if ratio.low <= 1 + AGREES_WITHIN and ratio.high >= 1 - AGREES_WITHIN:
            return "open"
        return "more" if ratio.value > 1 else "less"


def error_budget(runs: Sequence[Counterfactuals]) -> ErrorBudget:
    """The budget of many seeds. Raises BadParameter without any, or where they were not foretold."""
    foretold = [run.predicted for run in runs if run.predicted is not None]
    if not runs or len(foretold) < len(runs):
        raise BadParameter("counterfactual runs", len(foretold), "one seed or more, each with its prediction")
    misses = {one: np.array([run.misses[one] for run in runs]) for one in subsets(STAGES)}
    measured, predicted = Moments.measured(STAGES, misses), Moments.mean(foretold)
    rms = {one: _root(squares(m)) for one, m in misses.items()}
    every = frozenset(STAGES)
    seeds = np.array([run.seed for run in runs])
    return ErrorBudget(
        tuple(run.seed for run in runs),
        measured,
        predicted,
        attribute(STAGES, rms),
        attribute(STAGES, {one: predicted.rms_m(one) for one in misses}),
        _rms_interval(squares(misses[frozenset()]), seeds),
        {one: _rms_interval(squares(misses[every - {one}]), seeds) for one in STAGES},
        _rms_interval(misses[frozenset()][:, 2] ** 2, seeds),
    )


def squares(misses: Float[Array, "seeds 3"]) -> Float[Array, "seeds"]:
    """Squared distance in the plane [m^2]."""
    return (misses[:, :2] ** 2).sum(axis=1)


def _root(values: Float[Array, "seeds"]) -> float:
    return float(np.sqrt(values.mean()))


def _rms_interval(values: Float[Array, "seeds"], seeds: Array) -> Interval:
    found = clustered_interval(values, seeds)
    low, high = (
        float(np.sqrt(max(end, 0.0))) if np.isfinite(end) else np.nan for end in (found.low, found.high)
    )
    return Interval(float(np.sqrt(found.value)), low, high, found.n)


def _over(interval: Interval, by: float) -> Interval:
    with np.errstate(divide="ignore", invalid="ignore"):
        value, low, high = np.array([interval.value, interval.low, interval.high]) / by
    return Interval(float(value), float(low), float(high), interval.n)
