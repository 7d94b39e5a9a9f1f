"""Drawings of a benchmark: intervals and ranks."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from vision_robot.evaluate.metrics import metric_named
from vision_robot.evaluate.score import Score
from vision_robot.evaluate.statistics import Ranking
from vision_robot.report.figure import ACCENT, FAINT, INK, WIDTH_IN, draw
from vision_robot.report.page import Figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

__all__ = ["TEXT_PT", "interval_chart", "rank_diagram", "titled"]

TEXT_PT = 9.6
"""Nine pixels on a phone 360 wide, where a drawing has to shrink a little."""

LETTER_IN = 0.068
"""Of a letter of that size, in the mean."""

ROW_IN = 0.2
WIDE = 30.0


def interval_chart(scores: Sequence[Score], methods: Sequence[str]) -> Figure:
    """One metric of one scene: a row for each method, value and 95 % interval."""
    metric = metric_named(scores[0].metric)
    by_method = {score.method: score for score in scores}
    shown = [by_method[name] for name in methods if name in by_method]
    best = (max if metric.better == "higher" else min)(score.value for score in shown)
    height = 0.62 + ROW_IN * len(shown)
    left = 0.15 + LETTER_IN * max(len(score.method) for score in shown)
    values = np.array([score.value for score in shown])
    log = bool((values > 0).all() and values.max() > WIDE * values.min())

    def paint(canvas: "Canvas") -> None:
        canvas.subplots_adjust(left=left / WIDTH_IN, bottom=0.48 / height, right=1 - 0.16 / WIDTH_IN)
        axes = canvas.add_subplot()
        if log:
            axes.set_xscale("log")
            axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
            axes.minorticks_off()
        axes.axvline(best, color=FAINT, linewidth=0.8, zorder=0)
        for row, score in enumerate(shown):
            axes.plot([score.value], [row], "o", color=ACCENT, markersize=4.5)
            if np.isfinite(score.low):
                low = max(score.low, values.min() / WIDE) if log else score.low
                axes.plot([low, score.high], [row, row], color=ACCENT, linewidth=1.8)
        axes.set_yticks(range(len(shown)), [score.method for score in shown])
        axes.set_ylim(len(shown) - 0.5, -0.5)
        if not log:
            axes.locator_params(axis="x", nbins=5)
        axes.set_xlabel(titled(metric.name, metric.unit, metric.better))

    scene, most = scores[0].scene, max(score.n for score in shown)
    return Figure(
        draw(paint, height_in=height, text_pt=TEXT_PT),
        alt=f"{metric.name} of each method on {scene}",
        caption=f"{scene}: {metric.meaning}; 95 % intervals over {most} seed{'s' if most > 1 else ''}. "
        "The line marks the best mean.",
    )


def rank_diagram(ranking: Ranking, metric_name: str) -> Figure:
    """Average ranks; a bar joins methods that the data cannot tell apart (critical difference diagram)."""
    metric, m = metric_named(metric_name), len(ranking.methods)
    half = (m + 1) // 2
    bars = [group for group in ranking.groups if group[1] > group[0]]
    height = 0.62 + 0.2 * half + 0.1 * len(bars)
    # Names stand to the left and right of the axis, and take what they need of the width.
    beside = LETTER_IN * (max(map(len, ranking.methods)) + 6)
    axis = max(WIDTH_IN - 2 * beside, 1.0)
    aside = beside / axis

    def paint(canvas: "Canvas") -> None:
        canvas.subplots_adjust(left=0.0, right=1.0, bottom=0.0, top=1.0)
        axes = canvas.add_subplot()
        axes.set_axis_off()
        axes.set_xlim(-aside, 1 + aside)
        axes.set_ylim(-(height - 0.36), 0.36)  # in inches, the axis at zero
        place = (ranking.ranks - 1) / max(m - 1, 1)
        axes.plot([0, 1], [0, 0], color=INK, linewidth=0.9)
        step = max(1, round(0.16 * m / axis))
        for rank in range(1, m + 1):
            at = (rank - 1) / max(m - 1, 1)
            axes.plot([at, at], [0, 0.06], color=INK, linewidth=0.7)
            if (rank - 1) % step == 0 or rank == m:
                axes.text(at, 0.1, str(rank), ha="center")
        for number, (start, end) in enumerate(bars):
            y = -0.09 - 0.1 * number
            axes.plot([place[start] - 0.012, place[end] + 0.012], [y, y], color=INK, linewidth=2.8)
        for i, (name, rank) in enumerate(zip(ranking.methods, ranking.ranks, strict=True)):
            left = i < half
            depth = -(0.24 + 0.1 * len(bars) + 0.2 * (i if left else m - 1 - i))
            edge = -0.06 if left else 1.06
            axes.plot([place[i], place[i], edge], [0, depth, depth], color=FAINT, linewidth=0.9, zorder=0)
            text, side = f"{name} {rank:.1f}", "right" if left else "left"
            axes.text(edge + (-0.03 if left else 0.03), depth, text, ha=side, va="center_baseline")

    return Figure(
        draw(paint, height_in=height, text_pt=TEXT_PT),
        alt=f"Average ranks of {', '.join(ranking.methods)} by {metric.name}",
        caption=f"Average rank by {metric.name} over {ranking.blocks} scenes and seeds, 1 the best. A bar "
        "joins methods between which no pair differs (paired sign-flip tests over seeds, 5 % after Holm).",
    )


def titled(name: str, unit: str, better: str) -> str:
    """A metric as an axis or a column calls it; many names end with their unit."""
    shown = f" [{unit}]" if unit and not name.endswith(f"_{unit}") else ""
    return f"{name}{shown}{f', {better} is better' if better else ''}"
