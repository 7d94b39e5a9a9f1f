"""Drawings of a benchmark: intervals, ranks, and scores against severity."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from vision_robot.evaluate.metrics import metric_named
from vision_robot.evaluate.score import Score
from vision_robot.evaluate.statistics import Breakdown, Ranking
from vision_robot.report.figure import FAINT, INK, WIDTH_IN, draw, view_colours
from vision_robot.report.page import Figure
from vision_robot.report.quantity import compact
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas

__all__ = ["Curve", "interval_chart", "rank_diagram", "severity_chart"]

Curve = tuple[Float[Array, "k"], Float[Array, "seeds k"], Breakdown]
"""Severities, scores by seed, and where they fall under the threshold."""

ROW_IN = 0.17


def interval_chart(scores: Sequence[Score], methods: Sequence[str]) -> Figure:
    """One metric of one scene: a row for each method, value and 95 % interval."""
    metric = metric_named(scores[0].metric)
    by_method = {score.method: score for score in scores}
    shown = [by_method[name] for name in methods if name in by_method]
    best = (max if metric.better == "higher" else min)(score.value for score in shown)
    height = 0.55 + ROW_IN * len(shown)

    def paint(canvas: "Canvas") -> None:
        canvas.subplots_adjust(left=1.45 / WIDTH_IN)
        axes = canvas.add_subplot()
        axes.axvline(best, color=FAINT, linewidth=0.6, zorder=0)
        for row, (score, colour) in enumerate(zip(shown, view_colours(len(shown)), strict=True)):
            axes.plot([score.value], [row], "o", color=colour, markersize=4)
            if np.isfinite(score.low):
                axes.plot([score.low, score.high], [row, row], color=colour, linewidth=1.6)
        axes.set_yticks(range(len(shown)), [score.method for score in shown])
        axes.set_ylim(len(shown) - 0.5, -0.5)
        axes.set_xlabel(_titled(metric.name, metric.unit, metric.better))

    scene = scores[0].scene
    return Figure(
        draw(paint, height_in=height),
        alt=f"{metric.name} of each method on {scene}",
        caption=f"{scene}: {metric.meaning}; 95 % interval over {max(score.n for score in shown)} seed(s). "
        "The line marks the best mean.",
    )


def rank_diagram(ranking: Ranking, metric_name: str) -> Figure:
    """Average ranks; a bar joins methods that the data cannot tell apart (critical difference diagram)."""
    metric, m = metric_named(metric_name), len(ranking.methods)
    half = (m + 1) // 2
    bars = [group for group in ranking.groups if group[1] > group[0]]
    height = 0.5 + 0.16 * half + 0.09 * len(bars)

    def paint(canvas: "Canvas") -> None:
        canvas.subplots_adjust(left=0.02, right=0.98, bottom=0.02, top=0.98)
        axes = canvas.add_subplot()
        axes.set_axis_off()
        axes.set_xlim(-0.9, 1.9)
        deepest = -(0.35 + 0.1 * len(bars) + 0.2 * half)
        axes.set_ylim(deepest, 0.35)
        place = (ranking.ranks - 1) / max(m - 1, 1)
        axes.plot([0, 1], [0, 0], color=INK, linewidth=0.8)
        for rank in range(1, m + 1):
            at = (rank - 1) / max(m - 1, 1)
            axes.plot([at, at], [0, 0.06], color=INK, linewidth=0.6)
            axes.text(at, 0.1, str(rank), ha="center", fontsize=7)
        for number, (start, end) in enumerate(bars):
            y = -0.1 - 0.1 * number
            axes.plot([place[start] - 0.008, place[end] + 0.008], [y, y], color=INK, linewidth=2.6)
        for i, (name, rank) in enumerate(zip(ranking.methods, ranking.ranks, strict=True)):
            left = i < half
            depth = -(0.25 + 0.1 * len(bars) + 0.2 * (i if left else m - 1 - i))
            edge = -0.08 if left else 1.08
            axes.plot([place[i], place[i], edge], [0, depth, depth], color=FAINT, linewidth=0.7)
            text, side = f"{name}  {rank:.2f}", "right" if left else "left"
            axes.text(edge + (-0.02 if left else 0.02), depth, text, ha=side, va="center_baseline")

    return Figure(
        draw(paint, height_in=height),
        alt=f"Average ranks of {', '.join(ranking.methods)} by {metric.name}",
        caption=f"Average rank by {metric.name} over {ranking.blocks} scenes and seeds, 1 the best. A bar "
        "joins methods between which no pair differs (paired sign-flip tests over seeds, 5 % after Holm).",
    )


def severity_chart(curves: Mapping[str, Curve], metric_name: str, dial: str, threshold: float) -> Figure:
    """Scores over the severity of one difficulty, with the point where each method breaks."""
    metric = metric_named(metric_name)

    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        axes.axhline(threshold, color=FAINT, linewidth=0.6, zorder=0)
        for (name, (severities, scores, breaks)), colour in zip(
            curves.items(), view_colours(len(curves)), strict=True
        ):
            _curve(axes, severities, scores, colour, name)
            if np.isfinite(breaks.severity):
                axes.plot([breaks.severity], [threshold], "x", color=colour, markersize=6)
        axes.set_ylim(-0.02, 1.02)
        axes.set_xlabel(dial)
        axes.set_ylabel(metric.name)
        axes.legend(loc="upper right", ncols=2)

    words = ", ".join(f"{name} {_breaking(breaks)}" for name, (_, _, breaks) in curves.items())
    return Figure(
        draw(paint, height_in=2.6),
        alt=f"{metric.name} against {dial}",
        caption=f"{metric.name} against {dial}: means over seeds, bands from the lowest to the highest seed. "
        f"Severity at which the mean falls under {threshold:g}: {words}.",
    )


def _curve(axes: "Axes", severities: Array, scores: Array, colour: str, name: str) -> None:
    axes.plot(severities, scores.mean(axis=0), "o-", color=colour, markersize=2.5, label=name)
    if len(scores) > 1:
        axes.fill_between(
            severities, scores.min(axis=0), scores.max(axis=0), color=colour, alpha=0.12, linewidth=0
        )


def _breaking(breaks: Breakdown) -> str:
    if not np.isfinite(breaks.severity):
        return "never"
    high = compact(breaks.high) if np.isfinite(breaks.high) else "never"
    return f"{compact(breaks.severity)} ({compact(breaks.low)} to {high})"


def _titled(name: str, unit: str, better: str) -> str:
    return f"{name}{f' [{unit}]' if unit else ''}, {better} is better"
