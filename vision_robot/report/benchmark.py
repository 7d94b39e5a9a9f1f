"""The page of a benchmark."""

from collections.abc import Sequence

import numpy as np

from vision_robot.evaluate.conclusion import compare_methods, sentence
from vision_robot.evaluate.dial import dials_of, measured
from vision_robot.evaluate.metrics import metric_named
from vision_robot.evaluate.score import Score, failures, scores
from vision_robot.evaluate.statistics import Ranking, rank_methods
from vision_robot.evaluate.sweep import Outcome
from vision_robot.report.benchmark_figures import interval_chart, rank_diagram, severity_chart
from vision_robot.report.page import Facts, Figures, Footer, Page, Paragraph, Remarks, Section, Table
from vision_robot.report.quantity import compact, listed
from vision_robot.report.versions import versions

__all__ = ["ranking_of", "benchmark_page"]

ABOUT_TIMING = (
    "Times are of cells that ran alone: one process, frames decoded into memory beforehand, nothing else of "
    "the benchmark computing. They depend on the machine; ratios between methods of one run carry further."
)

MOST_SENTENCES = 12


def benchmark_page(
    suite: str,
    outcomes: Sequence[Outcome],
    *,
    metric: str,
    threshold: float = 0.5,
    command: str = "",
    seed: int | None = None,
) -> Page:
    """Everything a suite found: who is ahead and how surely, where each method breaks, what failed.

    `metric` is the one that ranks; all others stand in the tables.
    """
    found = scores(outcomes)
    methods = list(dict.fromkeys(score.method for score in found))
    scenes = list(dict.fromkeys(score.scene for score in found))
    ranking = ranking_of(outcomes, metric, methods)
    sections = [
        Section("Result", (_facts(outcomes, ranking, metric), Remarks(_remarks(outcomes, scenes, metric)))),
        *_ranks(ranking, metric),
        Section("Scenes", (Figures(tuple(_charts(found, scenes, methods, metric))),)),
        *_breakdowns(outcomes, scenes, methods, metric, threshold),
        *(_table(found, name) for name in dict.fromkeys(score.metric for score in found)),
        *_failed(outcomes),
    ]
    summary = f"{len(methods)} methods on {len(scenes)} scenes, {_seeds(outcomes)} seed(s) each at most."
    return Page(f"Benchmark: {suite}", summary, tuple(sections), Footer(versions(), seed, command))


def ranking_of(outcomes: Sequence[Outcome], metric_name: str, methods: Sequence[str]) -> Ranking:
    """All methods over all scenes and seeds; a failure ranks last there, and is not left out."""
    metric = metric_named(metric_name)
    worst = -np.inf if metric.better == "higher" else np.inf
    table: dict[tuple[str, int], dict[str, float]] = {}
    for outcome in outcomes:
        value = outcome.figures.get(metric_name, np.nan)
        if np.isfinite(value) or outcome.failure is not None:
            block = table.setdefault((outcome.cell.scene, outcome.cell.seed), {})
            block[outcome.cell.method] = value if np.isfinite(value) else worst
    blocks = [key for key, row in table.items() if len(row) == len(methods)]
    values = np.array([[table[key][name] for name in methods] for key in blocks]).reshape(-1, len(methods))
    finite = values[np.isfinite(values)]
    # Beyond all others, and finite, so that differences can be taken.
    far = finite.min(initial=0) - 1 if metric.better == "higher" else finite.max(initial=0) + 1
    values = np.where(np.isfinite(values), values, far)
    clusters = np.array([seed for _, seed in blocks])
    return rank_methods(methods, values, clusters, higher_is_better=metric.better == "higher")


def _facts(outcomes: Sequence[Outcome], ranking: Ranking, metric: str) -> Facts:
    ahead = ranking.winner or listed([ranking.methods[i] for i in range(ranking.groups[0][1] + 1)])
    about = "differs from every other method" if ranking.winner else "cannot be told apart with these seeds"
    failed = sum(outcome.failure is not None for outcome in outcomes)
    return Facts(
        (
            (f"ahead by {metric}", ahead, about),
            ("scenes and seeds", str(ranking.blocks), "on which every method has a figure"),
            ("cells", str(len(outcomes)), f"{failed} failed" if failed else "none failed"),
            ("computing", f"{sum(outcome.seconds for outcome in outcomes):.0f} s", "all cells together"),
        )
    )


def _remarks(outcomes: Sequence[Outcome], scenes: Sequence[str], metric: str) -> tuple[tuple[str, str], ...]:
    """The comparisons of the first method of each scene with the second: what a reader asks first."""
    remarks = []
    for scene in scenes:
        pairs = compare_methods(outcomes, metric, scene)
        if not pairs:
            continue
        wins: dict[str, int] = {}
        for pair in pairs:
            wins[pair.better] = wins.get(pair.better, 0) + 1
        first = max(wins, key=lambda name: wins[name])
        rivals = [pair for pair in pairs if pair.better == first]
        closest = min(rivals, key=lambda pair: pair.difference.value)
        tone = {"better": "good", "equivalent": "note", "open": "caution"}[closest.verdict]
        remarks.append((tone, f"{sentence(closest)}."))
    return tuple(remarks[:MOST_SENTENCES])


def _ranks(ranking: Ranking, metric: str) -> list[Section]:
    if len(ranking.methods) < 2 or not ranking.blocks:
        return []
    return [Section("Ranks", (Figures((rank_diagram(ranking, metric),)),))]


def _charts(found: Sequence[Score], scenes: Sequence[str], methods: Sequence[str], metric: str):
    for scene in scenes:
        here = [score for score in found if score.scene == scene and score.metric == metric]
        if here:
            yield interval_chart(here, methods)


def _breakdowns(
    outcomes: Sequence[Outcome], scenes: Sequence[str], methods: Sequence[str], metric: str, threshold: float
) -> list[Section]:
    charts = []
    for dial in dials_of(scenes):
        curves = {
            name: curve
            for name in methods
            if (curve := measured(dial, outcomes, metric, name, threshold=threshold)) is not None
        }
        if curves:
            charts.append(severity_chart(curves, metric, dial.name, threshold))
    return [Section("Where methods break", (Figures(tuple(charts)),))] if charts else []


def _table(found: Sequence[Score], name: str) -> Section:
    """One metric: scenes down, methods across, each with its interval."""
    metric = metric_named(name)
    rows = [score for score in found if score.metric == name]
    methods = list(dict.fromkeys(score.method for score in rows))
    cells = {(score.scene, score.method): _cell(score) for score in rows}
    table = Table(
        ("scene", *methods),
        tuple(
            (scene, *(cells.get((scene, method), "–") for method in methods))
            for scene in dict.fromkeys(score.scene for score in rows)
        ),
        caption=f"{metric.meaning}{f' [{metric.unit}]' if metric.unit else ''}; {metric.better} is better; "
        "mean and 95 % interval over seeds.",
    )
    return Section(name, (Paragraph(ABOUT_TIMING), table) if metric.timing else (table,))


def _cell(score: Score) -> str:
    if not np.isfinite(score.low):
        return compact(score.value)
    return f"{compact(score.value)} ({compact(score.low)} to {compact(score.high)})"


def _failed(outcomes: Sequence[Outcome]) -> list[Section]:
    failed = failures(outcomes)
    if not failed:
        return []
    rows = tuple((one.scene, one.method, str(one.seed), one.reason) for one in failed)
    return [Section("Failures", (Table(("scene", "method", "seed", "reason"), rows, "Nothing is hidden."),))]


def _seeds(outcomes: Sequence[Outcome]) -> int:
    return len({outcome.cell.seed for outcome in outcomes})
