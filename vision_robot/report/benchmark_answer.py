"""What comes first on a benchmark's page: the answer in words, and the table it stands on."""

from collections.abc import Sequence

import numpy as np

from vision_robot.evaluate.answer import Answer, Standing, answer, answer_words
from vision_robot.evaluate.conclusion import needed_words, range_words, unit_words
from vision_robot.evaluate.metrics import metric_named
from vision_robot.evaluate.statistics import Interval, clustered_interval
from vision_robot.evaluate.sweep import Outcome
from vision_robot.report.benchmark_figures import titled
from vision_robot.report.page import Facts, Paragraph, Part, Remarks, Section, Table
from vision_robot.report.quantity import compact, listed

__all__ = ["EQUAL", "answer_section", "interval_cell", "scene_section", "summary_table"]

ABOUT_WORDS = (
    "A method is called better only where a paired test over seeds says so after correction for the number "
    "of pairs (Holm, 5 %), and two are called practically equal only where the test for that says so; the "
    "rest is not settled."
)

EQUAL = {"same": "the same throughout", "equal": "practically equal"}


def answer_section(outcomes: Sequence[Outcome], found: Answer | None) -> Section:
    """Who is ahead over all scenes, and all methods in a line each."""
    if found is None:
        return Section("Answer", (Paragraph("No method has a figure: see what failed."),))
    parts: list[Part] = [Remarks(tuple(answer_words(found))), _facts(outcomes, found)]
    return Section("Answer", (*parts, summary_table(outcomes, found), Paragraph(ABOUT_WORDS)))


def summary_table(outcomes: Sequence[Outcome], found: Answer) -> Table:
    """Methods in the order of their ranks, every metric's mean over all scenes, and how they stand."""
    names = dict.fromkeys(name for outcome in outcomes for name in outcome.figures)
    others = [name for name in names if name != found.metric.name]
    others.sort(key=lambda name: metric_named(name).timing)
    rows = tuple(
        (
            one.method,
            interval_cell(one.mean),
            _standing(one, found),
            *(interval_cell(_mean(outcomes, one.method, name)) for name in others),
            str(one.failed) if one.failed else "–",
        )
        for one in found.standings
    )
    columns = ("method", _titled(found.metric.name), f"to {found.standings[0].method}")
    return Table(
        (*columns, *map(_titled, others), "failed"),
        rows,
        f"Methods in the order of their average ranks by {found.metric.name}. Means and 95 % intervals over "
        "seeds of what each answered on all scenes; failed: scenes and seeds without an answer, which rank "
        "last and are in no mean.",
        pinned=True,
    )


def scene_section(outcomes: Sequence[Outcome], scenes: Sequence[str], metric: str) -> Section | None:
    """The same question scene by scene."""
    rows = []
    for scene in scenes:
        found = answer(outcomes, metric, scene)
        if found is None or len(found.standings) < 2:
            continue
        first = found.standings[0]
        about = f"{first.method}, {compact(first.mean.value)}{unit_words(found.metric)}"
        equal, unsettled, behind = (
            listed([one.method for verdict in verdicts for one in found.those(verdict)], 4) or "–"
            for verdicts in (EQUAL, ("open",), ("behind",))
        )
        rows.append((scene, found.winner or "nobody", about, equal, unsettled, behind))
    if not rows:
        return None
    table = Table(
        ("scene", "better than all others", "first in rank", "equal to it", "not settled", "behind"),
        tuple(rows),
        f"By {metric}, each scene for itself; pairs are corrected within a scene, not over the scenes.",
        pinned=True,
    )
    return Section("Scene by scene", (table,))


def interval_cell(found: Interval) -> str:
    """Value and ends; the ends are left out where there are none or all are one."""
    if found.n == 0:
        return "–"
    if not np.isfinite(found.low) or found.low == found.high:
        return compact(found.value)
    return f"{compact(found.value)} ({compact(found.low)} to {compact(found.high)})"


def _facts(outcomes: Sequence[Outcome], found: Answer) -> Facts:
    failed = sum(outcome.failure is not None for outcome in outcomes)
    return Facts(
        (
            (f"better in {found.metric.name}", found.winner or "nobody", "than every other method, by test"),
            ("scenes", str(found.scenes), f"{len(found.standings)} methods on each, or their failure"),
            ("seeds", str(found.seeds), "what intervals and tests count as one observation"),
            ("runs", str(len(outcomes)), f"{failed} failed" if failed else "none failed"),
        )
    )


def _standing(one: Standing, found: Answer) -> str:
    if one.verdict == "first":
        return "ranks first"
    if one.pair is None:
        return "nothing in common"
    unit, difference = unit_words(found.metric), one.pair.difference
    if one.verdict in EQUAL:
        return EQUAL[one.verdict]
    if one.verdict == "open":
        return f"not settled: {needed_words(one.pair)}"
    word = "better by" if one.verdict == "ahead" else "behind by"
    return f"{word} {compact(difference.value)}{unit} ({range_words(difference)}), p {_p(one.pair.p)}"


def _p(p: float) -> str:
    return "< 0.001" if p < 0.001 else f"= {p:.2g}"


def _mean(outcomes: Sequence[Outcome], method: str, name: str) -> Interval:
    metric = metric_named(name)
    mine = [o for o in outcomes if o.cell.method == method and name in o.figures]
    values = np.array([o.figures[name] for o in mine], dtype=float)
    found = clustered_interval(values, np.array([o.cell.seed for o in mine]))
    low, high = np.clip((found.low, found.high), metric.least, metric.most)
    return Interval(found.value, float(low), float(high), found.n)


def _titled(name: str) -> str:
    return titled(name, metric_named(name).unit, "")
