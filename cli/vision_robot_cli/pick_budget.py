"""The error budget that `vr pick --budget` asks for: run, as JSON and as text."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

from vision_robot.errors import NothingSeen, Unreachable
from vision_robot.evaluate.attribution import subsets
from vision_robot.evaluate.error_budget import ErrorBudget, error_budget
from vision_robot.evaluate.statistics import Interval
from vision_robot.pick.budget import Counterfactuals, counterfactuals
from vision_robot.pick.episodes import Plan
from vision_robot.pick.knowledge import STAGES
from vision_robot.pick.rehearsal import Rehearsal, rehearsed
from vision_robot.pick.world import World
from vision_robot_cli.output import note, progress

__all__ = ["MOST_SEEDS", "as_json", "as_text", "budget_of", "in_processes"]

MOST_SEEDS = 60
"""Enough to know a root mean square to some six parts in a hundred."""

WORDS = {
    "agrees": "as foretold",
    "more": "more than foretold: an error that no covariance holds",
    "less": "less than foretold",
    "open": "too few seeds to tell",
}


def budget_of(world: World, plan: Plan, seeds: Sequence[int], workers: int) -> ErrorBudget | None:
    """Of as many of the seeds as are needed; None where in none of them anything was seen and reached."""
    seeds = seeds[:MOST_SEEDS]
    try:
        rehearsal = rehearsed(world, plan, seed=seeds[0])
    except (NothingSeen, Unreachable) as error:
        note(f"no error budget: {error}")
        return None
    work = partial(_one, world, plan, list(subsets(STAGES)), rehearsal)
    runs = progress(in_processes(work, seeds, workers), "error budget", total=len(seeds))
    found = [run for run in runs if run is not None]
    return error_budget(found) if found else None


def _one(
    world: World, plan: Plan, sets: Sequence[frozenset[str]], rehearsal: Rehearsal, seed: int
) -> Counterfactuals | None:
    try:
        return counterfactuals(world, plan, seed, sets, rehearsal)
    except (NothingSeen, Unreachable):
        return None


def in_processes(work: Callable[[int], Any], seeds: Sequence[int], workers: int) -> Iterator[Any]:
    """What `work` gives for each seed, in order, in so many processes."""
    if workers == 1:
        yield from map(work, seeds)
        return
    from joblib import Parallel, delayed

    run: Any = Parallel(n_jobs=workers, backend="loky", return_as="generator")
    yield from run(delayed(work)(seed) for seed in seeds)


def as_json(budget: ErrorBudget) -> dict[str, Any]:
    """Millimetres: a stage's share of the measured rms, then what lies behind it."""
    return {
        **{stage: 1000 * share for stage, share in budget.shares.share.items()},
        "unexplained": 1000 * budget.shares.floor,
        "total": 1000 * budget.shares.total,
        "predicted": {
            **{stage: 1000 * share for stage, share in budget.predicted_shares.share.items()},
            "total": 1000 * budget.predicted_m,
        },
        "measured_over_predicted": _ends(budget.ratio, 1.0),
        "verdict": budget.verdict(),
        "alone": {
            stage: {
                "measured": _ends(budget.alone_m[stage], 1000),
                "predicted": 1000 * budget.predicted.alone_m(stage),
                "verdict": budget.verdict(stage),
            }
            for stage in STAGES
        },
        "products_mm2": {
            "stages": list(STAGES),
            "measured": 1e6 * budget.measured.position_m2,
            "predicted": 1e6 * budget.predicted.position_m2,
            "floor": 1e6 * budget.measured.floor_m2,
            "rest": 1e6 * budget.measured.rest_m2,
        },
        "seeds": len(budget.seeds),
    }


def as_text(budget: ErrorBudget) -> list[str]:
    """Lines of a table."""
    lines = [f"  of the millimetres at closing, open loop ({len(budget.seeds)} seeds, rms):"]
    lines.append(f"    {'':<12} {'share':>6}  {'alone':>6}  {'foretold alone':>14}")
    for stage in STAGES:
        share, alone = 1000 * budget.shares.share[stage], 1000 * budget.alone_m[stage].value
        foretold = 1000 * budget.predicted.alone_m(stage)
        lines.append(
            f"    {stage:<12} {share:6.2f}  {alone:6.2f}  {foretold:14.2f}  {WORDS[budget.verdict(stage)]}"
        )
    total, ratio = 1000 * budget.total_m.value, budget.ratio
    foretold, says = 1000 * budget.predicted_m, WORDS[budget.verdict()]
    lines.append(f"    {'total':<12} {total:6.2f}  {'':>6}  {foretold:14.2f}  {says}")
    lines.append(f"    measured / foretold {ratio.value:.2f} ({ratio.low:.2f} to {ratio.high:.2f})")
    return lines


def _ends(interval: Interval, scale: float) -> dict[str, float]:
    return {"value": scale * interval.value, "low": scale * interval.low, "high": scale * interval.high}
