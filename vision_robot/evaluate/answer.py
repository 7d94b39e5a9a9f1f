"""Who is ahead, by one metric: named only where every test allows it, else what is not settled and why."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.evaluate.conclusion import (
    EVERYWHERE,
    Comparison,
    compare_methods,
    needed_words,
    range_words,
    unit_words,
)
from vision_robot.evaluate.metrics import Metric, metric_named
from vision_robot.evaluate.statistics import Interval, Ranking, clustered_interval, rank_methods
from vision_robot.evaluate.sweep import Outcome

__all__ = ["Answer", "Standing", "answer", "answer_words", "ranking_of"]


@dataclass(frozen=True)
class Standing:
    """One method, and how it stands to the one that ranks first."""

    method: str
    mean: Interval
    """Over what it answered."""
    failed: int
    """Scenes and seeds on which it failed."""
    pair: Comparison | None
    """With the first; None for the first itself, and where they share nothing."""

    @property
    def verdict(self) -> str:
        """`first`, `behind`, `same`, `equal`, `open`, `ahead` (in the mean, not in rank) or `apart`."""
        if self.pair is None:
            return "apart"
        if self.pair.better == self.pair.worse:
            return "first"
        if self.pair.verdict != "better":
            return {"same": "same", "equivalent": "equal", "open": "open"}[self.pair.verdict]
        return "ahead" if self.pair.better == self.method else "behind"


@dataclass(frozen=True)
class Answer:
    """Methods in the order of their ranks, and the winner if there is one."""

    metric: Metric
    scene: str
    ranking: Ranking
    standings: tuple[Standing, ...]
    scenes: int
    seeds: int

    @property
    def winner(self) -> str | None:
        """The first, if it is better than every other by a corrected test and failed no oftener than any."""
        if len(self.standings) < 2:
            return None
        first, *others = self.standings
        clear = all(one.verdict == "behind" and one.failed >= first.failed for one in others)
        return first.method if clear else None

    def those(self, verdict: str) -> list[Standing]:
        """The methods with that verdict."""
        return [one for one in self.standings if one.verdict == verdict]


def answer(outcomes: Sequence[Outcome], metric_name: str, scene: str | None = None) -> Answer | None:
    """The standings on one scene, or on all of them; None where no method has a figure."""
    chosen = [o for o in outcomes if scene is None or o.cell.scene == scene]
    ranked = [o for o in chosen if metric_name in o.figures or o.failure is not None]
    known = [o for o in chosen if np.isfinite(o.figures.get(metric_name, np.nan))]
    methods = list(dict.fromkeys(o.cell.method for o in known))
    if not methods:
        return None
    ranking = ranking_of(chosen, metric_name, methods)
    pairs = {
        frozenset((one.better, one.worse)): one
        for one in compare_methods(chosen, metric_name, scene, methods)
    }
    first = ranking.methods[0]
    standings = []
    for method in ranking.methods:
        mine = [o for o in known if o.cell.method == method]
        there = {(o.cell.scene, o.cell.seed) for o in mine}
        failed = {(o.cell.scene, o.cell.seed) for o in ranked if o.cell.method == method} - there
        mean = clustered_interval(
            np.array([o.figures[metric_name] for o in mine]), np.array([o.cell.seed for o in mine])
        )
        pair = pairs.get(frozenset((first, method))) if method != first else _itself(metric_name, first, mean)
        standings.append(Standing(method, mean, len(failed), pair))
    return Answer(
        metric_named(metric_name),
        scene or EVERYWHERE,
        ranking,
        tuple(standings),
        len({o.cell.scene for o in known}),
        len({o.cell.seed for o in known}),
    )


def ranking_of(outcomes: Sequence[Outcome], metric_name: str, methods: Sequence[str]) -> Ranking:
    """All methods over all scenes and seeds; a failure ranks last there, and is not left out."""
    metric = metric_named(metric_name)
    higher = metric.better == "higher"
    worst = -np.inf if higher else np.inf
    table: dict[tuple[str, int], dict[str, float]] = {}
    for outcome in outcomes:
        value = outcome.figures.get(metric_name, np.nan)
        row = table.setdefault((outcome.cell.scene, outcome.cell.seed), {})
        if np.isfinite(value):
            row[outcome.cell.method] = value
        elif outcome.failure is not None:
            row.setdefault(outcome.cell.method, worst)
    blocks = [key for key, row in table.items() if all(name in row for name in methods)]
    values = np.array([[table[key][name] for name in methods] for key in blocks]).reshape(-1, len(methods))
    finite = values[np.isfinite(values)]
    # Beyond all others, and finite, so that differences can be taken.
    far = finite.min(initial=0) - 1 if higher else finite.max(initial=0) + 1
    values = np.where(np.isfinite(values), values, far)
    clusters = np.array([seed for _, seed in blocks])
    return rank_methods(methods, values, clusters, higher_is_better=higher)


def answer_words(found: Answer) -> list[tuple[str, str]]:
    """The answer as (tone, sentence): what may be said first, then what may not."""
    first, *others = found.standings
    unit, name = unit_words(found.metric), found.metric.name
    where = f"on {found.scene}" if found.scene != EVERYWHERE else _over(found)
    value = f"{first.mean.value:.3g}{unit}"
    if np.isfinite(first.mean.low) and first.mean.low < first.mean.high:
        value += f" ({range_words(first.mean)})"
    if not others:
        return [("note", f"{first.method} has {name} {value} {where}; there is nothing to compare it with.")]
    seeds = f"{found.seeds} seed{'s' if found.seeds > 1 else ''}"
    if found.winner:
        nearest = min(others, key=lambda one: one.pair.difference.value if one.pair else np.inf)
        assert nearest.pair is not None, "a winner was compared with everyone"
        return [
            (
                "good",
                f"{first.method} is better in {name} than every other method {where}: {value}, {seeds}; the "
                f"nearest, {nearest.method}, is behind by {nearest.pair.difference.value:.3g}{unit} "
                f"({range_words(nearest.pair.difference)}).",
            )
        ]
    words = [
        (
            "note",
            f"No method is better in {name} than every other {where}. {first.method} ranks first: {value}, "
            f"{seeds}.",
        )
    ]
    same, equal, unsettled, ahead = (found.those(verdict) for verdict in ("same", "equal", "open", "ahead"))
    if same:
        words.append(("note", f"The same as {first.method} on every scene and seed: {_names(same)}."))
    if equal:
        zone = max(one.pair.zone for one in equal if one.pair)
        text = f"Practically equal to {first.method} (within {zone:.2g}{unit}): {_names(equal)}."
        words.append(("note", text))
    if unsettled:
        listed = ", ".join(f"{one.method} ({needed_words(one.pair)})" for one in unsettled if one.pair)
        words.append(("caution", f"Not settled against {first.method}; would be needed: {listed}."))
    if ahead:
        text = f"Better in the mean than {first.method}, though lower in rank: {_names(ahead)}."
        words.append(("caution", text))
    behind = found.those("behind")
    if behind:
        words.append(("note", f"Behind {first.method}: {_names(behind)}."))
    if first.failed:
        text = f"{first.method} failed on {first.failed} scenes and seeds, which its figure leaves out."
        words.append(("caution", text))
    return words


def _over(found: Answer) -> str:
    return f"over {found.scenes} scenes" if found.scenes > 1 else "on the one scene"


def _names(some: Sequence[Standing]) -> str:
    return ", ".join(one.method for one in some)


def _itself(metric_name: str, method: str, mean: Interval) -> Comparison:
    none = Interval(0.0, 0.0, 0.0, mean.n)
    return Comparison(metric_named(metric_name), EVERYWHERE, method, method, none, 1.0, True, 0.0, None, 0)
