"""How much a method's score hangs on its own parameters."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.evaluate.statistics import Interval, clustered_interval
from vision_robot.evaluate.sweep import Outcome

__all__ = ["Sensitivity", "Variant", "sensitivities", "variant", "without_variants"]


@dataclass(frozen=True)
class Variant:
    """A method with one parameter set otherwise: ``NAME:PARAMETER=VALUE``."""

    method: str
    parameter: str
    value: str
    """A number, or a factor of what the method chooses itself, such as x0.5."""

    @property
    def number(self) -> float:
        """The number, for putting variants in order; NaN for a word."""
        try:
            return float(self.value.removeprefix("x"))
        except ValueError:
            return np.nan


@dataclass(frozen=True)
class Sensitivity:
    """Mean score of a method at each value of one parameter, on the scenes and seeds that all have."""

    method: str
    parameter: str
    values: tuple[str, ...]
    """In rising order."""
    scores: tuple[Interval, ...]
    usual: Interval
    """As the method runs by itself."""

    @property
    def spread(self) -> float:
        """Between the highest and the lowest mean, the usual one included."""
        means = [self.usual.value, *(one.value for one in self.scores)]
        return float(np.nanmax(means) - np.nanmin(means))


def variant(name: str) -> Variant | None:
    """What a method's name says of it; None for a method as it is."""
    method, colon, rest = name.partition(":")
    parameter, equals, value = rest.partition("=")
    return Variant(method, parameter, value) if colon and equals else None


def without_variants(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """The outcomes of methods as they are."""
    return [outcome for outcome in outcomes if variant(outcome.cell.method) is None]


def sensitivities(outcomes: Sequence[Outcome], metric: str) -> list[Sensitivity]:
    """One for each method and parameter that has variants, the most sensitive first."""
    figures: dict[str, dict[tuple[str, int], float]] = {}
    for outcome in outcomes:
        value = outcome.figures.get(metric, np.nan)
        if np.isfinite(value):
            figures.setdefault(outcome.cell.method, {})[outcome.cell.scene, outcome.cell.seed] = value
    families: dict[tuple[str, str], list[Variant]] = {}
    for name in figures:
        found = variant(name)
        if found is not None:
            families.setdefault((found.method, found.parameter), []).append(found)
    made = []
    for (method, parameter), members in families.items():
        members.sort(key=lambda one: one.number)
        tables = [figures[f"{method}:{parameter}={one.value}"] for one in members]
        usual = figures.get(method, {})
        shared = set(usual).intersection(*tables)
        if shared:
            scores = tuple(_mean(table, shared) for table in tables)
            values = tuple(one.value for one in members)
            made.append(Sensitivity(method, parameter, values, scores, _mean(usual, shared)))
    return sorted(made, key=lambda one: -one.spread)


def _mean(table: dict[tuple[str, int], float], where: set[tuple[str, int]]) -> Interval:
    keys = sorted(where)
    return clustered_interval(np.array([table[key] for key in keys]), np.array([seed for _, seed in keys]))
