"""Tables of a benchmark's page: failures, all figures, breakdown points, power, machines."""

from collections.abc import Mapping, Sequence

import numpy as np

from vision_robot.evaluate.answer import Answer
from vision_robot.evaluate.conclusion import needed_words
from vision_robot.evaluate.metrics import metric_named
from vision_robot.evaluate.score import Score, failures
from vision_robot.evaluate.statistics import Breakdown, Interval
from vision_robot.evaluate.sweep import Outcome
from vision_robot.report.benchmark_answer import EQUAL, interval_cell
from vision_robot.report.page import Paragraph, Section, Table
from vision_robot.report.quantity import compact, listed

__all__ = ["breakdown_table", "failure_section", "figure_table", "made_section", "power_section"]

ABOUT_TIMING = (
    "Times are of runs that had the machine to themselves: one after the other, in one process, on one "
    "thread, frames in memory beforehand, nothing else of the benchmark computing, what happens once left "
    "out. They depend on the machine; ratios between methods of one run carry further."
)
MOST_REASON = 220


def failure_section(outcomes: Sequence[Outcome]) -> Section:
    """What failed, before anything else: runs with the same reason in one line."""
    grouped: dict[tuple[str, str], dict[str, list[int]]] = {}
    for one in failures(outcomes):
        grouped.setdefault((one.method, one.reason), {}).setdefault(one.scene, []).append(one.seed)
    if not grouped:
        return Section("Failures", (Paragraph(f"None: all {len(outcomes)} runs gave an answer."),))
    rows = tuple(
        (
            method,
            listed(list(scenes), 4),
            str(sum(map(len, scenes.values()))),
            reason if len(reason) <= MOST_REASON else f"{reason[:MOST_REASON]} …",
        )
        for (method, reason), scenes in grouped.items()
    )
    caption = "Runs without an answer. They rank last where they happened, and break a curve there."
    return Section("Failures", (Table(("method", "scenes", "runs", "reason"), rows, caption, pinned=True),))


def breakdown_table(
    found: Mapping[str, Mapping[str, Breakdown]], methods: Sequence[str], metric: str, threshold: float
) -> Table:
    """Where each method breaks (rows) on each difficulty (columns)."""
    passes = "falls under" if metric_named(metric).better == "higher" else "rises over"
    shown = [method for method in methods if any(method in row for row in found.values())]
    return Table(
        ("method", *found),
        tuple((method, *(_breaking(row.get(method)) for row in found.values())) for method in shown),
        f"Severity at which the mean {metric} {passes} {compact(threshold)}, with its 95 % interval over "
        "seeds; never: not within the severities tried.",
        pinned=True,
    )


def figure_table(found: Sequence[Score], name: str) -> Section:
    """One metric: scenes down, methods across, each with its interval."""
    metric = metric_named(name)
    rows = [score for score in found if score.metric == name]
    methods = list(dict.fromkeys(score.method for score in rows))
    cells = {(s.scene, s.method): interval_cell(Interval(s.value, s.low, s.high, s.n)) for s in rows}
    unit = f" [{metric.unit}]" if metric.unit else ""
    table = Table(
        ("scene", *methods),
        tuple(
            (scene, *(cells.get((scene, method), "–") for method in methods))
            for scene in dict.fromkeys(score.scene for score in rows)
        ),
        f"{metric.meaning}{unit}; {metric.better} is better; mean and 95 % interval over seeds.",
        pinned=True,
    )
    return Section(name, (table,))


def power_section(found: Answer | None) -> Section | None:
    """What these seeds could have shown, and how many would settle the rest."""
    if found is None or len(found.standings) < 2:
        return None
    pairs = [(one, one.pair) for one in found.standings[1:] if one.pair is not None]
    if not pairs:
        return None
    rows = tuple(
        (
            one.method,
            {**EQUAL, "open": "not settled"}.get(one.verdict, one.verdict),
            compact(pair.difference.value),
            compact(pair.detectable) if pair.detectable is not None else "nothing yet",
            str(pair.difference.n),
            needed_words(pair) if one.verdict == "open" else "–",
        )
        for one, pair in pairs
    )
    first, metric = found.standings[0].method, found.metric
    unit = f" [{metric.unit}]" if metric.unit else ""
    least = max(pair.least_seeds for _, pair in pairs)
    table = Table(
        ("method", f"to {first}", f"difference{unit}", f"could be shown{unit}", "seeds", "would settle it"),
        rows,
        f"Power, by {metric.name} over all scenes. Could be shown: the least true difference that these "
        "seeds would find four times in five at a level of 5 % shared among all pairs.",
        pinned=True,
    )
    about = (
        f"With so many methods at least {least} seeds are needed before any difference can be called one: "
        f"sign-flip tests of k seeds give no p below 2^(1 − k), and every pair has to bear the correction."
    )
    return Section("Power", (Paragraph(about), table))


def made_section(outcomes: Sequence[Outcome], timing: str) -> Section:
    """How it was measured: times, machines, computing."""
    alone = [o for o in outcomes if o.cell.alone and o.failure is None]
    parts: list[Paragraph] = []
    if alone:
        parts.append(Paragraph(f"{len(alone)} runs measure time. {timing or ABOUT_TIMING}"))
        shares = [o.cpu_seconds / o.seconds for o in alone if o.cpu_seconds is not None and o.seconds > 0]
        if shares:
            low, middle = np.min(shares), np.median(shares)
            words = f"While they ran they had {100 * middle:.0f} % of a core in the median"
            spoiled = "" if middle > 0.9 else " Something else was computing: measure again when nothing is."
            parts.append(Paragraph(f"{words}, {100 * low:.0f} % at the least.{spoiled}"))
    machines = list(dict.fromkeys(o.machine for o in outcomes if o.machine))
    if machines:
        parts.append(Paragraph(f"Measured on: {'; '.join(machines)}."))
    total = sum(outcome.seconds for outcome in outcomes)
    parts.append(
        Paragraph(
            f"{len(outcomes)} runs took {total:.0f} s of computing. Each is kept in a file named after a "
            "hash of all it is a result of, so that the command below finds them again and measures only "
            "what is missing; the same seeds give the same figures, times apart."
        )
    )
    return Section("How it was measured", tuple(parts))


def _severity(value: float) -> str:
    return compact(value) if np.isfinite(value) else "never"


def _breaking(found: Breakdown | None) -> str:
    if found is None:
        return "–"
    if found.low == found.high == found.severity:
        return _severity(found.severity)
    return f"{_severity(found.severity)} ({_severity(found.low)} to {_severity(found.high)})"
