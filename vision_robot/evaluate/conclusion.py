"""What a benchmark shows, in words that are never stronger than its numbers."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.evaluate.metrics import Metric, metric_named
from vision_robot.evaluate.statistics import Interval, compare_pairs, holm, seeds_needed
from vision_robot.evaluate.sweep import Outcome
from vision_robot.types import Array, Float

__all__ = ["Comparison", "compare_methods", "sentence", "severity_curve"]

LEVEL = 0.05


@dataclass(frozen=True)
class Comparison:
    """Two methods on the same scenes and seeds."""

    metric: Metric
    scene: str
    better: str
    """The method with the better mean."""
    worse: str
    difference: Interval
    """Better less worse, so that a positive number is an advantage whichever way the metric points."""
    p: float
    """Corrected for all pairs of this metric and scene (Holm)."""
    equivalent: bool
    seeds_needed: int | None
    """Seeds at which a difference that matters would show, for pairs that are neither."""

    @property
    def verdict(self) -> str:
        """`better`, `equivalent` or `open`."""
        if self.equivalent:
            return "equivalent"
        return "better" if self.p < LEVEL else "open"


def compare_methods(
    outcomes: Iterable[Outcome], metric_name: str, scene: str, methods: Sequence[str] | None = None
) -> list[Comparison]:
    """All pairs of methods on one scene by one metric, each with the better of the two first."""
    metric = metric_named(metric_name)
    table = _table([o for o in outcomes if o.cell.scene == scene], metric_name)
    names = [name for name in methods or table if name in table]
    sign = 1.0 if metric.better == "higher" else -1.0
    found = []
    for i, a in enumerate(names):
        for b in names[i + 1 :]:
            shared = np.array(sorted(table[a].keys() & table[b].keys()))
            ours, theirs = (np.array([sign * table[name][s] for s in shared]) for name in (a, b))
            if not len(shared):
                continue
            first, second = (a, b) if ours.mean() >= theirs.mean() else (b, a)
            if first == b:
                ours, theirs = theirs, ours
            zone = metric.zone_at(float(np.abs(ours).mean()))
            test = compare_pairs(ours, theirs, shared, zone=zone)
            needed = seeds_needed(ours - theirs, smallest=zone)
            found.append(
                Comparison(metric, scene, first, second, test.difference, test.p, test.equivalent, needed)
            )
    corrected = holm([one.p for one in found])
    return [
        Comparison(one.metric, one.scene, one.better, one.worse, one.difference, float(p), one.equivalent,
                   one.seeds_needed)
        for one, p in zip(found, corrected, strict=True)
    ]  # fmt: skip


def _table(outcomes: Iterable[Outcome], metric: str) -> dict[str, dict[int, float]]:
    """Method -> seed -> mean figure."""
    gathered: dict[str, dict[int, list[float]]] = {}
    for outcome in outcomes:
        value = outcome.figures.get(metric, np.nan)
        if np.isfinite(value):
            gathered.setdefault(outcome.cell.method, {}).setdefault(outcome.cell.seed, []).append(value)
    return {
        method: {seed: float(np.mean(values)) for seed, values in seeds.items()}
        for method, seeds in gathered.items()
    }


def sentence(one: Comparison) -> str:
    """The comparison in one sentence."""
    metric, found = one.metric, one.difference
    unit = f" {metric.unit}" if metric.unit else ""
    if one.verdict == "equivalent":
        return (
            f"{one.scene}: {one.better} and {one.worse} are equivalent in {metric.name} "
            f"(difference {_range(found)}{unit}, {found.n} seeds)"
        )
    if one.verdict == "better":
        return (
            f"{one.scene}: {one.better} is better than {one.worse} in {metric.name} "
            f"by {found.value:.3g}{unit} ({_range(found)}, p = {one.p:.2g}, {found.n} seeds)"
        )
    more = f"; about {one.seeds_needed} seeds would settle it" if one.seeds_needed else ""
    return (
        f"{one.scene}: {found.n} seed(s) cannot tell {one.better} from {one.worse} in {metric.name} "
        f"(difference {_range(found)}{unit}, p = {one.p:.2g}){more}"
    )


def _range(found: Interval) -> str:
    if not np.isfinite(found.low):
        return f"{found.value:.3g}"
    return f"{found.low:.3g} to {found.high:.3g}"


def severity_curve(
    outcomes: Sequence[Outcome], metric: str, method: str, scenes: Sequence[str]
) -> Float[Array, "seeds k"]:
    """Figures of one method by seed (rows) over the scenes of one dial (columns), whole rows only.

    A failure is a figure of zero: a method that gives up on hard scenes breaks there.
    """
    mine = [outcome for outcome in outcomes if outcome.cell.method == method]
    table = [
        {o.cell.seed: o.figures.get(metric, 0.0) for o in mine if o.cell.scene == scene} for scene in scenes
    ]
    shared = sorted(set.intersection(*(set(row) for row in table))) if table else []
    return np.array([[row[seed] for row in table] for seed in shared]).reshape(len(shared), len(scenes))
