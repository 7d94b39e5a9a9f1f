"""The page of a benchmark."""

from collections.abc import Mapping, Sequence

import numpy as np

from vision_robot.evaluate.answer import answer
from vision_robot.evaluate.dial import dials_of, measured
from vision_robot.evaluate.metrics import metric_named
from vision_robot.evaluate.score import Score, scores
from vision_robot.evaluate.sensitivity import Sensitivity, sensitivities, without_variants
from vision_robot.evaluate.sweep import Outcome
from vision_robot.report.benchmark_answer import answer_section, scene_section
from vision_robot.report.benchmark_curves import sensitivity_chart, severity_chart
from vision_robot.report.benchmark_figures import interval_chart, rank_diagram
from vision_robot.report.benchmark_tables import (
    breakdown_table,
    failure_section,
    figure_table,
    made_section,
    power_section,
)
from vision_robot.report.film_strip import LEGEND
from vision_robot.report.page import Figures, Footer, Page, Paragraph, Picture, Section, Strips
from vision_robot.report.quantity import compact
from vision_robot.report.versions import versions

__all__ = ["benchmark_page"]

MOST_STRIP_BYTES = 6_000_000
"""Of all strips together, so that a page can be sent by mail."""


def benchmark_page(
    suite: str,
    outcomes: Sequence[Outcome],
    *,
    metric: str,
    threshold: float = 0.5,
    command: str = "",
    seed: int | None = None,
    timing: str = "",
    axes: Mapping[str, str] | None = None,
) -> Page:
    """Everything a suite found: who is ahead and how surely, what failed, where each method breaks.

    `metric` is the one that ranks; all others stand in the tables. `timing` says how times were measured
    where it was not in the usual way, `axes` what the severities of a difficulty are.
    """
    usual = without_variants(outcomes)
    found = scores(usual)
    methods = list(dict.fromkeys(outcome.cell.method for outcome in usual))
    scenes = list(dict.fromkeys(outcome.cell.scene for outcome in usual))
    overall = answer(usual, metric)
    sections = [
        answer_section(usual, overall),
        failure_section(outcomes),
        scene_section(usual, scenes, metric) if len(scenes) > 1 else None,
        _breakdowns(usual, scenes, methods, metric, threshold, axes or {}),
        _ranks(usual, metric),
        _strips(outcomes, metric),
        _charts(found, scenes, methods, metric),
        _sensitivity(sensitivities(outcomes, metric), metric),
        power_section(overall),
        *(figure_table(found, name) for name in dict.fromkeys(score.metric for score in found)),
        made_section(outcomes, timing),
    ]
    seeds = len({outcome.cell.seed for outcome in outcomes})
    summary = (
        f"{len(methods)} methods on {len(scenes)} scene{'s' if len(scenes) > 1 else ''}, {seeds} "
        f"seed{'s' if seeds > 1 else ''}. {metric}: {metric_named(metric).meaning}, "
        f"{metric_named(metric).better} is better."
    )
    shown = tuple(section for section in sections if section is not None)
    return Page(f"Benchmark: {suite}", summary, shown, Footer(versions(), seed, command))


def _ranks(outcomes: Sequence[Outcome], metric: str) -> Section | None:
    found = answer(outcomes, metric)
    if found is None or len(found.standings) < 2 or not found.ranking.blocks:
        return None
    return Section("Ranks", (Figures((rank_diagram(found.ranking, metric),)),))


def _charts(
    found: Sequence[Score], scenes: Sequence[str], methods: Sequence[str], metric: str
) -> Section | None:
    charts = []
    for scene in scenes:
        here = [score for score in found if score.scene == scene and score.metric == metric]
        if here:
            charts.append(interval_chart(here, methods))
    return Section("Scenes", (Figures(tuple(charts)),)) if charts else None


def _breakdowns(
    outcomes: Sequence[Outcome],
    scenes: Sequence[str],
    methods: Sequence[str],
    metric: str,
    threshold: float,
    axes: Mapping[str, str],
) -> Section | None:
    charts, breaks = [], {}
    for dial in dials_of(scenes):
        curves = {
            name: curve
            for name in methods
            if (curve := measured(dial, outcomes, metric, name, threshold=threshold)) is not None
        }
        if curves:
            charts.append(severity_chart(curves, metric, dial.name, threshold, axes.get(dial.name, "")))
            breaks[dial.name] = {name: curve[2] for name, curve in curves.items()}
    if not charts:
        return None
    table = breakdown_table(breaks, methods, metric, threshold)
    return Section("Where methods break", (Figures(tuple(charts)), table))


def _strips(outcomes: Sequence[Outcome], metric: str) -> Section | None:
    """What the figures look like, the worst of each scene first."""
    with_strip = [outcome for outcome in outcomes if outcome.strip]
    if not with_strip:
        return None
    sign = -1 if metric_named(metric).better == "lower" else 1
    scenes = list(dict.fromkeys(outcome.cell.scene for outcome in with_strip))
    with_strip.sort(key=lambda o: (scenes.index(o.cell.scene), sign * o.figures.get(metric, -sign * np.inf)))
    pictures, size = [], 0
    for outcome in with_strip:
        assert outcome.strip is not None, "chosen for it"
        size += len(outcome.strip)
        if size > MOST_STRIP_BYTES:
            break
        cell = outcome.cell
        value = f"{metric} {compact(outcome.figures.get(metric, np.nan))}"
        about = f"{cell.scene}, {cell.method}, seed {cell.seed}: {value}"
        pictures.append(Picture(outcome.strip, f"Frames of {about}", about))
    left = len(with_strip) - len(pictures)
    told = f" {left} more are in the results and not here, to keep the page small." if left else ""
    about = f"The worst of each scene first. {LEGEND}{told}"
    return Section("Film strips", (Paragraph(about), Strips(tuple(pictures))))


def _sensitivity(found: Sequence[Sensitivity], metric: str) -> Section | None:
    if not found:
        return None
    parameters = dict.fromkeys(one.parameter for one in found)
    charts = [
        sensitivity_chart([one for one in found if one.parameter == parameter], metric, parameter)
        for parameter in parameters
    ]
    about = "How much the scores hang on the methods' own parameters, the most sensitive first."
    return Section("Sensitivity", (Paragraph(about), Figures(tuple(charts))))
