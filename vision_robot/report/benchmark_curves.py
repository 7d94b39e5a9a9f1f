"""Curves of a benchmark: scores against the severity of a difficulty, and against a method's parameters."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from vision_robot.evaluate.metrics import metric_named
from vision_robot.evaluate.sensitivity import Sensitivity
from vision_robot.evaluate.statistics import Breakdown, clustered_interval
from vision_robot.report.benchmark_figures import TEXT_PT, titled
from vision_robot.report.figure import FAINT, WIDTH_IN, draw, view_colours
from vision_robot.report.page import Figure
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas

__all__ = ["Curve", "sensitivity_chart", "severity_chart"]

Curve = tuple[Float[Array, "k"], Float[Array, "seeds k"], Breakdown]
"""Severities, scores by seed, and where they fall under the threshold."""

MARKERS, DASHES = "os^vD<>pPX", ("-", "--", ":", "-.")
"""Colour alone tells nobody apart who does not see it."""

WIDE = 30.0
"""Scores whose ratio is larger are drawn on a logarithmic scale."""

KEY_ROW_IN, KEY_TOP_IN = 0.19, 0.52


def severity_chart(
    curves: Mapping[str, Curve], metric_name: str, dial: str, threshold: float, meaning: str = ""
) -> Figure:
    """Means over the severity of one difficulty with their 95 % bands, and a cross where each breaks."""
    metric = metric_named(metric_name)
    rows = (len(curves) + 1) // 2
    height = 2.5 + KEY_TOP_IN + KEY_ROW_IN * rows

    def paint(canvas: "Canvas") -> None:
        canvas.subplots_adjust(bottom=(KEY_TOP_IN + KEY_ROW_IN * rows) / height, left=0.66 / WIDTH_IN)
        axes = canvas.add_subplot()
        axes.axhline(threshold, color=FAINT, linewidth=0.8, zorder=0)
        all_means = []
        for k, ((name, (severities, scores, breaks)), colour) in enumerate(
            zip(curves.items(), view_colours(len(curves)), strict=True)
        ):
            means = _curve(axes, severities, scores, colour, k, name)
            all_means.append(means)
            if np.isfinite(breaks.severity):
                axes.plot([breaks.severity], [threshold], "x", color=colour, markersize=7, zorder=4)
        _scale(axes, np.concatenate(all_means), metric.most, threshold)
        axes.set_xlabel(f"severity of {dial}")
        axes.set_ylabel(titled(metric.name, metric.unit, ""))
        axes.legend(loc="upper center", bbox_to_anchor=(0.42, -0.19), ncols=2, handlelength=2.6)

    passes = "under" if metric.better == "higher" else "over"
    return Figure(
        draw(paint, height_in=height, text_pt=TEXT_PT),
        alt=f"{metric.name} of {', '.join(curves)} against the severity of {dial}",
        caption=f"{metric.name} against the severity of {dial}: means with 95 % bands over seeds, "
        f"{metric.better} is better. A cross marks where a mean goes {passes} {threshold:g}."
        + (f" Severity: {meaning}." if meaning else ""),
    )


def sensitivity_chart(found: Sequence[Sensitivity], metric_name: str, parameter: str) -> Figure:
    """Scores of the methods that share a parameter against its values."""
    metric = metric_named(metric_name)
    values = list(dict.fromkeys(value for one in found for value in one.values))
    values.sort(key=lambda value: float(value.removeprefix("x")) if _is_number(value) else np.inf)
    rows = (len(found) + 1) // 2
    height = 2.0 + KEY_TOP_IN + KEY_ROW_IN * rows

    def paint(canvas: "Canvas") -> None:
        canvas.subplots_adjust(bottom=(KEY_TOP_IN + KEY_ROW_IN * rows) / height, left=0.66 / WIDTH_IN)
        axes = canvas.add_subplot()
        for k, (one, colour) in enumerate(zip(found, view_colours(len(found)), strict=True)):
            at = [values.index(value) for value in one.values]
            means = [score.value for score in one.scores]
            low = [score.low if np.isfinite(score.low) else score.value for score in one.scores]
            high = [score.high if np.isfinite(score.high) else score.value for score in one.scores]
            axes.axhline(one.usual.value, color=colour, linewidth=0.8, linestyle=":")
            axes.plot(
                at, means, f"{MARKERS[k % len(MARKERS)]}-", color=colour, markersize=4, label=one.method
            )
            axes.fill_between(at, low, high, color=colour, alpha=0.14, linewidth=0)
        axes.set_xticks(range(len(values)), values)
        axes.set_xlabel(parameter)
        axes.set_ylabel(titled(metric.name, metric.unit, ""))
        axes.legend(loc="upper center", bbox_to_anchor=(0.42, -0.24), ncols=2)

    spreads = ", ".join(f"{one.method} {one.spread:.2g}" for one in found)
    return Figure(
        draw(paint, height_in=height, text_pt=TEXT_PT),
        alt=f"{metric.name} against {parameter}",
        caption=f"{metric.name} against {parameter}, with 95 % bands; dotted: as the method runs by itself. "
        f"Between the best and the worst value: {spreads}.",
    )


def _curve(axes: "Axes", severities: Array, scores: Array, colour: str, k: int, name: str) -> Array:
    bands = [clustered_interval(column, np.arange(len(column))) for column in scores.T]
    whole = np.isfinite(scores).all(axis=0)  # where a run failed there is no mean
    means = np.where(whole, [band.value for band in bands], np.nan)
    style = MARKERS[k % len(MARKERS)] + DASHES[k % len(DASHES)]
    axes.plot(severities, means, style, color=colour, markersize=4, label=name)
    low, high = np.array([(band.low, band.high) for band in bands]).T
    axes.fill_between(
        severities, low, high, where=whole & np.isfinite(low), color=colour, alpha=0.14, linewidth=0
    )
    return means[np.isfinite(means)]


def _scale(axes: "Axes", means: Array, most: float, threshold: float) -> None:
    positive = means[means > 0]
    if np.isfinite(most):
        axes.set_ylim(-0.02 * most, 1.02 * most)
    elif len(positive) and positive.max() > WIDE * positive.min():
        axes.set_yscale("log")
        axes.set_ylim(max(positive.min() / 1.5, positive.max() / 1e5), max(positive.max(), threshold) * 1.5)
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.minorticks_off()
    else:
        axes.set_ylim(0, 1.1 * max(means.max(initial=0), threshold))


def _is_number(value: str) -> bool:
    return value.removeprefix("x").replace(".", "", 1).replace("-", "", 1).isdigit()
