"""The error budget of a grasp: a table, a waterfall, and foretold against measured."""

from typing import TYPE_CHECKING

import numpy as np

from vision_robot.evaluate.error_budget import ErrorBudget
from vision_robot.report.figure import ACCENT, FAINT, INK, WARM, WIDTH_IN, draw
from vision_robot.report.page import Figure, Figures, Paragraph, Part, Remarks, Table
from vision_robot.report.quantity import compact, listed

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

__all__ = ["budget_parts", "waterfall"]

TOGETHER = 0.05
"""Share of the total mean square from which what two stages do together has a bar of its own."""

SAYS = {
    "agrees": "as foretold",
    "more": "more than foretold",
    "less": "less than foretold",
    "open": "too few seeds to tell",
}

ABOUT = (
    "The same grasp, open loop, was made again with every set of stages replaced by the truth. A stage's "
    "share "
    "is what its mending saves, averaged over all orders in which stages may be mended (Shapley's value), "
    "so that "
    "the shares add up to the total. Alone is what a stage costs when all others are right. Foretold is "
    "what the "
    "covariances say beforehand, carried through the chain to first order: camera and plane with their joint "
    "covariance, the station by the touched marks, the tracker and the servos by a rehearsal at known places."
)


def budget_parts(budget: ErrorBudget) -> tuple[Part, ...]:
    """What a page says of a budget."""
    return (
        Remarks(_remarks(budget)),
        Figures((waterfall(budget), against_figure(budget))),
        _table(budget),
        Paragraph(ABOUT),
    )


def _remarks(budget: ErrorBudget) -> tuple[tuple[str, str], ...]:
    ratio, verdict = budget.ratio, budget.verdict()
    total, foretold = 1000 * budget.total_m.value, 1000 * budget.predicted_m
    tone = {"agrees": "good", "open": "note", "more": "caution", "less": "caution"}[verdict]
    remarks = [
        (
            tone,
            f"At closing the tool was {compact(total)} mm off (rms over {len(budget.seeds)} seeds); the "
            "covariances "
            f"foretold {compact(foretold)} mm: {compact(ratio.value, 2)} times as much"
            f"{_between(ratio.low, ratio.high)}, {SAYS[verdict]}.",
        )
    ]
    surprising = [one for one in budget.measured.stages if budget.verdict(one) == "more"]
    if surprising:
        remarks.append(
            (
                "caution",
                f"More than foretold comes from {listed(surprising)}: an error that is in no covariance, "
                "such as a "
                "camera that was moved after it was calibrated, or a sigma that is too small.",
            )
        )
    largest = max(budget.shares.share, key=lambda one: budget.shares.share[one])
    remarks.append(
        (
            "note",
            f"Mend {largest} first: its share is {compact(1000 * budget.shares.share[largest], 2)} mm of "
            f"{compact(total)} mm.",
        )
    )
    return tuple(remarks)


def _between(low: float, high: float) -> str:
    return f" ({compact(low, 2)} to {compact(high, 2)})" if np.isfinite(low) else ""


def _table(budget: ErrorBudget) -> Table:
    rows = []
    for stage in budget.measured.stages:
        cost = budget.alone_m[stage]
        rows.append(
            (
                stage,
                f"{1000 * budget.shares.share[stage]:.3f}",
                f"{1000 * budget.predicted_shares.share[stage]:.3f}",
                f"{1000 * cost.value:.3f}",
                _range_mm(cost.low, cost.high),
                f"{1000 * budget.predicted.alone_m(stage):.3f}",
                SAYS[budget.verdict(stage)],
            )
        )
    total = budget.total_m
    rows += [
        ("left with all true", f"{1000 * budget.shares.floor:.3f}", "", "", "", "", ""),
        (
            "together",
            f"{1000 * budget.shares.total:.3f}",
            f"{1000 * budget.predicted_m:.3f}",
            f"{1000 * total.value:.3f}",
            _range_mm(total.low, total.high),
            f"{1000 * budget.predicted_m:.3f}",
            SAYS[budget.verdict()],
        ),
    ]
    return Table(
        ("stage", "share", "share foretold", "alone", "95 %", "alone foretold", ""),
        tuple(rows),
        caption="Root mean square of the position error at closing [mm], by stage. Shares add up; what "
        "stages cost "
        "alone does not, since errors of camera and plane cancel.",
        numeric=frozenset({1, 2, 3, 5}),
    )


def _range_mm(low: float, high: float) -> str:
    return f"{1000 * low:.3f} to {1000 * high:.3f}" if np.isfinite(low) else "–"


def bars_mm2(budget: ErrorBudget) -> list[tuple[str, float, float]]:
    """(name, measured, foretold) [mm^2] of stages, of pairs that matter, and of the rest; they add up."""
    stages, measured, foretold = (
        budget.measured.stages,
        budget.measured.position_m2,
        budget.predicted.position_m2,
    )
    total = float(measured.sum() + budget.measured.floor_m2 + budget.measured.rest_m2)
    bars = [(one, float(measured[i, i]), float(foretold[i, i])) for i, one in enumerate(stages)]
    left = [budget.measured.floor_m2 + budget.measured.rest_m2, 0.0]
    for i, one in enumerate(stages):
        for j in range(i):
            pair = (2 * float(measured[i, j]), 2 * float(foretold[i, j]))
            if max(map(abs, pair)) > TOGETHER * total:
                bars.append((f"{stages[j]} with {one}", *pair))
            else:
                left = [left[0] + pair[0], left[1] + pair[1]]
    bars.append(("all else together", left[0], left[1]))
    return [(name, 1e6 * a, 1e6 * b) for name, a, b in bars]


def waterfall(budget: ErrorBudget) -> Figure:
    """Mean squares piled up to the total: what stages cost, and what they give back together."""
    bars = bars_mm2(budget)
    ends = np.cumsum([value for _, value, _ in bars])
    foretold_total = sum(value for _, _, value in bars)

    def paint(canvas: "Canvas") -> None:
        canvas.subplots_adjust(left=1.35 / WIDTH_IN)
        axes = canvas.add_subplot()
        start = 0.0
        for row, ((_, value, foretold), end) in enumerate(zip(bars, ends, strict=True)):
            axes.barh(row, value, left=start, height=0.6, color=ACCENT if value >= 0 else WARM, alpha=0.75)
            axes.barh(row, foretold, left=start, height=0.82, fill=False, edgecolor=INK, linewidth=0.7)
            axes.plot([end, end], [row - 0.3, row + 1.3], color=FAINT, linewidth=0.7)
            start = float(end)
        axes.barh(len(bars), start, height=0.6, color=INK, alpha=0.75)
        axes.barh(len(bars), foretold_total, height=0.82, fill=False, edgecolor=INK, linewidth=0.7)
        axes.axvline(0, color=INK, linewidth=0.6)
        axes.set_yticks(range(len(bars) + 1), [*(name for name, _, _ in bars), "total"])
        axes.set_ylim(len(bars) + 0.6, -0.6)
        axes.set_xlabel("mean square of the position error [mm²]")

    root = compact(float(np.sqrt(max(ends[-1], 0.0))))
    return Figure(
        draw(paint, height_in=0.5 + 0.24 * (len(bars) + 1)),
        alt="Waterfall of the error budget by stage",
        caption="The budget as a waterfall: blue costs, orange is given back because two errors cancel; "
        "outlines are "
        f"what was foretold. Mean squares add up; the total is {root} mm rms.",
    )


def against_figure(budget: ErrorBudget) -> Figure:
    """Foretold against measured, with 20 % to either side."""
    stages = [one for one in budget.measured.stages if budget.alone_m[one].value > 0]
    foretold = [1000 * budget.predicted.alone_m(one) for one in stages] + [1000 * budget.predicted_m]
    measured = [budget.alone_m[one] for one in stages] + [budget.total_m]
    most = 1.15 * max([*foretold, *(1000 * _top(one.value, one.high) for one in measured)])

    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        axes.fill_between([0, most], [0, 0.8 * most], [0, 1.2 * most], color=FAINT, alpha=0.3, linewidth=0)
        axes.plot([0, most], [0, most], color=FAINT, linewidth=0.7)
        for name, x, y in zip([*stages, "total"], foretold, measured, strict=True):
            colour = INK if name == "total" else ACCENT
            axes.plot([x], [1000 * y.value], "o", color=colour, markersize=4)
            if np.isfinite(y.low):
                axes.plot([x, x], [1000 * y.low, 1000 * y.high], color=colour, linewidth=1.2)
            if max(x, 1000 * y.value) > 0.05 * most:
                axes.annotate(name, (x, 1000 * y.value), xytext=(5, -3), textcoords="offset points")
        axes.set_xlim(0, most)
        axes.set_ylim(0, most)
        axes.set_xlabel("foretold rms [mm]")
        axes.set_ylabel("measured rms [mm]")

    return Figure(
        draw(paint, height_in=0.72 * WIDTH_IN),
        alt="Measured against foretold errors by stage",
        caption="Each stage alone, and the total: measured, with its 95 % interval over seeds, against "
        "foretold. "
        "The band is 20 % to either side. Above it, a covariance is too small or an error is in none.",
    )


def _top(value: float, high: float) -> float:
    return high if np.isfinite(high) else value
