"""How `vr benchmark` shows its scores: text, JSON, pages, and against an older run."""

import json
import shlex
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from vision_robot.evaluate.answer import answer, answer_words
from vision_robot.evaluate.baseline import regressions
from vision_robot.evaluate.claim import Claim, claim_words, findings
from vision_robot.evaluate.conclusion import compare_methods
from vision_robot.evaluate.score import Score, failures, scores
from vision_robot.evaluate.sensitivity import without_variants
from vision_robot_cli.benchmark_run import SuiteRun
from vision_robot_cli.output import LimitMissed, note, plain

__all__ = ["as_json", "as_text", "check_baseline", "write_reports", "write_tables"]

MOST_LINES = 400
"""Scores up to so many are printed in full."""

CLAIM_METRICS = ("success_auc",)
"""Claims are asked by these too: who follows well may not be who stays silent about the rest."""


def as_json(runs: Sequence[SuiteRun]) -> dict[str, Any]:
    """The object of `vr benchmark --json`."""
    return {
        "scores": [asdict(score) for score in _all_scores(runs)],
        "failures": [asdict(one) for run in runs for one in failures(run.outcomes)],
        "conclusions": [text for run in runs for text in _conclusions(run)],
        "claims": [
            {
                "who": claim.who,
                "method": claim.method,
                "rivals": claim.rivals,
                "metric": metric,
                "words": words,
            }
            for run in runs
            for claim, metric, words in _claims(run)
        ],
        "comparisons": [one for run in runs for one in _comparisons(run)],
    }


def as_text(runs: Sequence[SuiteRun]) -> str:
    """Scores by suite, scene and metric, then what may be concluded; of long runs the metric that ranks."""
    lines: list[str] = []
    for run in runs:
        lines.append(run.suite.name)
        shown = sorted(scores(run.outcomes), key=lambda one: (one.scene, one.metric))
        short = len(shown) > MOST_LINES
        if short:
            usual = without_variants(run.outcomes)
            shown = [one for one in scores(usual) if one.metric == run.suite.metric]
        last = ("", "")
        for score in shown:
            if (score.scene, score.metric) != last:
                unit = f" [{score.unit}]" if score.unit else ""
                lines.append(f"  {score.scene}: {score.metric}{unit}, {score.better} is better")
                last = (score.scene, score.metric)
            lines.append(f"    {score.method:<22} {_interval(score)}")
        lines += [f"  failed: {one.scene}, {one.method}, seed {one.seed}: {one.reason}"
                  for one in failures(run.outcomes)]  # fmt: skip
        overall, *by_scene = _conclusions(run) or ["No method has a figure."]
        lines += [f"  {text}" for text in (*by_scene, overall)]  # last what is read first
        lines += [f"  {text}" for _, _, words in _claims(run) for text in words]
        lines += ["  all metrics: --json, --tables DIR, --report FILE"] if short else []
    return "\n".join(lines)


def write_reports(runs: Sequence[SuiteRun], path: Path, seed: int) -> None:
    """One page a suite: at `path`, or for several suites beside it with the suite's name."""
    from vision_robot.report.benchmark import benchmark_page
    from vision_robot.report.page import write_page

    command = shlex.join(["vr", *sys.argv[1:]])
    for run in runs:
        place = path if len(runs) == 1 else path.with_stem(f"{path.stem}-{run.suite.name}")
        page = benchmark_page(
            run.suite.name,
            run.outcomes,
            metric=run.suite.metric,
            threshold=run.suite.threshold,
            command=command,
            seed=seed,
            timing=run.suite.timing,
            axes=run.suite.axes,
        )
        write_page(page, place)


def write_tables(runs: Sequence[SuiteRun], folder: Path) -> None:
    """All scores, and each suite's summary, for a paper or another program."""
    from vision_robot.files import write_text
    from vision_robot.report.benchmark_answer import summary_table
    from vision_robot.report.benchmark_files import scores_csv, table_csv, table_latex

    write_text(folder / "scores.csv", scores_csv(_all_scores(runs)))
    content = {"schema": "vr.benchmark/1", **plain(as_json(runs))}
    write_text(folder / "scores.json", json.dumps(content, indent=1, allow_nan=False) + "\n")
    for run in runs:
        usual = without_variants(run.outcomes)
        found = answer(usual, run.suite.metric)
        if found is not None:
            table = summary_table(usual, found)
            name = f"summary-{run.suite.name}"
            write_text(folder / f"{name}.csv", table_csv(table))
            write_text(folder / f"{name}.tex", table_latex(table, label=f"tab:{run.suite.name}"))


def check_baseline(runs: Sequence[SuiteRun], before: Sequence[Score]) -> None:
    """Raise LimitMissed where a score is worse than the older run's beyond noise; all of them are noted."""
    worse = regressions(_all_scores(runs), before)
    for one in worse:
        now = one.after
        note(
            f"worse: {now.suite}, {now.scene}, {now.method}: {now.metric} {one.before.value:.4g} -> "
            f"{now.value:.4g} (noise {one.noise:.2g})"
        )
    if worse:
        first = worse[0].after
        name = f"{first.metric} of {first.method} on {first.scene}"
        raise LimitMissed(name, first.value, worse[0].before.value, first.unit)


def _all_scores(runs: Sequence[SuiteRun]) -> list[Score]:
    return [score for run in runs for score in scores(run.outcomes)]


def _conclusions(run: SuiteRun) -> list[str]:
    """What may be said over all scenes, then scene by scene."""
    usual, metric = without_variants(run.outcomes), run.suite.metric
    scenes = list(dict.fromkeys(outcome.cell.scene for outcome in usual))
    asked = [None, *(scenes if len(scenes) > 1 else ())]
    found = [answer(usual, metric, scene) for scene in asked]
    return [" ".join(text for _, text in answer_words(one)) for one in found if one is not None]


def _comparisons(run: SuiteRun) -> list[dict[str, Any]]:
    """All pairs over all scenes, in figures."""
    pairs = compare_methods(without_variants(run.outcomes), run.suite.metric)
    keys = ("scene", "better", "worse", "p", "verdict", "seeds_needed")
    return [
        {
            "suite": run.suite.name,
            "metric": run.suite.metric,
            **{key: getattr(one, key) for key in keys},
            "difference": one.difference.value,
            "low": one.difference.low,
            "high": one.difference.high,
            "seeds": one.difference.n,
        }
        for one in pairs
    ]


def _claims(run: SuiteRun) -> list[tuple[Claim, str, list[str]]]:
    """Each claim, the metric it is asked by, and what the run says of it; by the metrics that are shares."""
    usual = without_variants(run.outcomes)
    asked = [(claim, metric) for claim in run.suite.claims for metric in (run.suite.metric, *CLAIM_METRICS)]
    told = [(claim, metric, claim_words(findings(usual, metric, claim), claim)) for claim, metric in asked]
    return [one for one in told if one[2]]


def _interval(score: Score) -> str:
    if score.low != score.low:
        return f"{score.value:.4g}"
    return f"{score.value:.4g} ({score.low:.4g} to {score.high:.4g}, n = {score.n})"
