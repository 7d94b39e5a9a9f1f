"""What a benchmark shows of two methods, in words that are never stronger than its numbers."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.evaluate.metrics import Metric, metric_named
from vision_robot.evaluate.statistics import Interval, compare_pairs, detectable, holm, seeds_needed
from vision_robot.evaluate.sweep import Outcome
from vision_robot.types import Array, Float

__all__ = [
    "EVERYWHERE",
    "LEVEL",
    "Comparison",
    "compare_methods",
    "needed_words",
    "range_words",
    "sentence",
    "severity_curve",
    "unit_words",
]

LEVEL = 0.05
EVERYWHERE = "all scenes"

Blocks = dict[tuple[str, int], float]
"""Scene and seed -> figure."""


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
    """Within the zone of no consequence, at a level divided by the number of pairs (Bonferroni)."""
    zone: float
    seeds_needed: int | None
    """Seeds at which a difference as large as this one, if it is real and matters, would show."""
    least_seeds: int
    """With fewer no difference at all can show among so many pairs."""
    detectable: float | None = None
    """Smallest difference that these seeds would show four times in five."""
    same: bool = False
    """Whether their figures are the same on every scene and seed: seen to be, which no test can better."""
    failed: int = 0
    """Scenes and seeds left out because one of the two failed there."""

    @property
    def verdict(self) -> str:
        """`same`, `equivalent`, `better` or `open`."""
        if self.same:
            return "same"
        if self.equivalent:
            return "equivalent"
        return "better" if self.p < LEVEL else "open"


def compare_methods(
    outcomes: Iterable[Outcome],
    metric_name: str,
    scene: str | None = None,
    methods: Sequence[str] | None = None,
) -> list[Comparison]:
    """All pairs of methods by one metric on one scene, or on all of them together; the better of each first.

    Differences are taken scene by scene and seed by seed, and averaged by seed: scenes of one seed are
    one observation.
    """
    metric = metric_named(metric_name)
    chosen = [o for o in outcomes if scene is None or o.cell.scene == scene]
    table, failed = _table(chosen, metric_name)
    names = [name for name in methods or table if name in table]
    pairs = [(a, b) for i, a in enumerate(names) for b in names[i + 1 :] if table[a].keys() & table[b].keys()]
    found = [
        _compared(metric, scene or EVERYWHERE, (a, b), (table[a], table[b]), LEVEL / len(pairs))
        for a, b in pairs
    ]
    return [
        replace(one, p=float(p), failed=len(failed.get(one.better, set()) | failed.get(one.worse, set())))
        for one, p in zip(found, holm([one.p for one in found]), strict=True)
    ]


def _compared(
    metric: Metric, scene: str, names: tuple[str, str], figures: tuple[Blocks, Blocks], level: float
) -> Comparison:
    shared = sorted(figures[0].keys() & figures[1].keys())
    sign = 1.0 if metric.better == "higher" else -1.0
    ours, theirs = (np.array([sign * one[key] for key in shared]) for one in figures)
    better, worse = names
    if ours.mean() < theirs.mean():
        better, worse, ours, theirs = worse, better, theirs, ours
    seeds = np.array([seed for _, seed in shared])
    zone = metric.zone_at(float(np.abs(ours).mean()))
    test = compare_pairs(ours, theirs, seeds, zone=zone, level=level)
    by_seed = np.array([(ours - theirs)[seeds == seed].mean() for seed in np.unique(seeds)])
    needed = seeds_needed(by_seed, smallest=max(zone, abs(test.difference.value)), level=level)
    # With k seeds no sign-flip test gives less than 2^(1-k), and Holm multiplies it by the pairs.
    least = int(np.ceil(1 - np.log2(level)))
    if needed is not None:
        needed = max(needed, least, test.difference.n + 1)
    smallest = detectable(by_seed, level=level) if test.difference.n >= least else None
    told = (test.difference, test.p, test.equivalent, zone, needed, least, smallest)
    return Comparison(metric, scene, better, worse, *told, same=bool((ours == theirs).all()))


def _table(
    outcomes: Iterable[Outcome], metric: str
) -> tuple[dict[str, Blocks], dict[str, set[tuple[str, int]]]]:
    """Method -> its mean figures; method -> where it failed and has none."""
    gathered: dict[str, dict[tuple[str, int], list[float]]] = {}
    failed: dict[str, set[tuple[str, int]]] = {}
    for outcome in outcomes:
        cell = outcome.cell
        value = outcome.figures.get(metric, np.nan)
        if np.isfinite(value):
            gathered.setdefault(cell.method, {}).setdefault((cell.scene, cell.seed), []).append(value)
        elif outcome.failure is not None:
            failed.setdefault(cell.method, set()).add((cell.scene, cell.seed))
    table = {
        method: {key: float(np.mean(values)) for key, values in blocks.items()}
        for method, blocks in gathered.items()
    }
    return table, {method: where - table.get(method, {}).keys() for method, where in failed.items()}


def sentence(one: Comparison) -> str:
    """The comparison in one sentence."""
    found, unit = one.difference, unit_words(one.metric)
    seeds = f"{found.n} seed{'s' if found.n > 1 else ''}"
    where = f"{one.scene}: "
    left_out = f"; {one.failed} runs in which one of them failed do not count here" if one.failed else ""
    if one.verdict == "same":
        return (
            f"{where}{one.better} and {one.worse} have the same {one.metric.name} on every scene and seed "
            f"({seeds}){left_out}"
        )
    if one.verdict == "equivalent":
        return (
            f"{where}{one.better} and {one.worse} are practically equal in {one.metric.name} "
            f"(difference {range_words(found)}{unit}, within {one.zone:.2g}{unit}; {seeds}){left_out}"
        )
    if one.verdict == "better":
        return (
            f"{where}{one.better} is better than {one.worse} in {one.metric.name} "
            f"by {found.value:.3g}{unit} ({range_words(found)}, p = {one.p:.2g}, {seeds}){left_out}"
        )
    return (
        f"{where}not settled between {one.better} and {one.worse} in {one.metric.name} "
        f"(difference {range_words(found)}{unit}, p = {one.p:.2g}, {seeds}): "
        f"{needed_words(one)} would be needed{left_out}"
    )


def needed_words(one: Comparison) -> str:
    """How many seeds an open comparison asks for."""
    if one.seeds_needed is None:
        return f"at least {max(one.least_seeds, one.difference.n + 1)} seeds"
    return f"about {one.seeds_needed} seeds"


def unit_words(metric: Metric) -> str:
    """The unit after a blank, or nothing."""
    return f" {metric.unit}" if metric.unit else ""


def range_words(found: Interval) -> str:
    """The ends of an interval, or its value where there are none."""
    if not np.isfinite(found.low):
        return f"{found.value:.3g}"
    return f"{found.low:.3g} to {found.high:.3g}"


def severity_curve(
    outcomes: Sequence[Outcome], metric: str, method: str, scenes: Sequence[str]
) -> Float[Array, "seeds k"]:
    """Figures of one method by seed (rows) over the scenes of one dial (columns), whole rows only.

    A failure is as bad as a figure can be, zero or infinite: a method that gives up on hard scenes breaks
    there.
    """
    worst = 0.0 if metric_named(metric).better == "higher" else np.inf
    table, failed = _table([o for o in outcomes if o.cell.method == method], metric)
    known = {**dict.fromkeys(failed.get(method, ()), worst), **table.get(method, {})}
    rows = [{seed: value for (where, seed), value in known.items() if where == scene} for scene in scenes]
    shared = sorted(set.intersection(*(set(row) for row in rows))) if rows else []
    return np.array([[row[seed] for row in rows] for seed in shared]).reshape(len(shared), len(scenes))
