"""How `vr pick` shows what happened: text and JSON."""

from typing import Any

import numpy as np

from vision_robot.evaluate.statistics import wilson_interval
from vision_robot.pick.causes import ending_of
from vision_robot.pick.episode import RUNGS, Episode
from vision_robot.pick.summary import Spread, summary_of
from vision_robot_cli import pick_budget
from vision_robot_cli.pick_run import PickRun

__all__ = ["as_json", "as_text", "grasp_share"]


def grasp_share(run: PickRun) -> float:
    """Share of episodes in which the thing was lifted and held."""
    return summary_of(run.episodes).reached_rung["lifted"] / len(run.episodes)


def as_json(run: PickRun) -> dict[str, Any]:
    """The object of `vr pick --json`."""
    found = summary_of(run.episodes)
    return {
        "episodes": found.episodes,
        "loop": run.plan.loop,
        "tracker": run.plan.tracker,
        "scene": run.scene,
        "things": [item.name for item in run.world.design.items],
        "faults": list(run.faults),
        **{f"{rung}_success": found.reached_rung[rung] / found.episodes for rung in ("reached", "gripped")},
        "grasp_success": found.reached_rung["lifted"] / found.episodes,
        "place_success": found.reached_rung["placed"] / found.episodes,
        "intervals": {rung: _interval(found.reached_rung[rung], found.episodes) for rung in RUNGS},
        "position_error_mm": _scaled(found.position_m, 1000),
        "yaw_error_deg": _scaled(found.yaw_rad, 180 / np.pi),
        "place_error_mm": _scaled(found.placing_m, 1000),
        "seconds": _scaled(found.seconds, 1),
        "pick_seconds": _scaled(found.pick_seconds, 1),
        "tries": sum(one.tries for one in run.episodes),
        "put_aside": sum(one.cleared for one in run.episodes),
        "endings": found.endings,
        "looks": _scaled(found.looks, 1),
        "error_budget": None if run.budget is None else pick_budget.as_json(run.budget),
        "each": [_row(episode) for episode in run.episodes],
    }


def as_text(run: PickRun) -> str:
    """Rungs with intervals, errors, and what failed."""
    found = summary_of(run.episodes)
    lines = [
        f"{found.episodes} episodes, scene {run.scene}, {run.plan.loop} loop, tracker {run.plan.tracker}"
    ]
    if run.faults:
        lines[0] += f", with {', '.join(run.faults)}"
    for rung in RUNGS:
        interval = wilson_interval(found.reached_rung[rung], found.episodes)
        lines.append(
            f"  {rung:<8} {found.reached_rung[rung]:>4}   {100 * interval.value:5.1f} %"
            f"   ({100 * interval.low:.1f} to {100 * interval.high:.1f})"
        )
    for name, spread, scale, unit in (
        ("tool at closing", found.position_m, 1000, "mm"),
        ("turned by", found.yaw_rad, 180 / np.pi, "deg"),
        ("placed off by", found.placing_m, 1000, "mm"),
        ("time to pick", found.pick_seconds, 1, "s"),
        ("time in all", found.seconds, 1, "s"),
    ):
        if np.isfinite(spread.median):
            median, p95 = scale * spread.median, scale * spread.p95
            lines.append(f"  {name:<15} median {median:.2f} {unit}, 95 % within {p95:.2f} {unit}")
    if run.budget is not None:
        lines += pick_budget.as_text(run.budget)
    ended = [f"{count} {ending}" for ending, count in found.endings.items() if count]
    if ended:
        lines.append(f"  not placed: {', '.join(ended)}")
    if found.cleared:
        lines.append(f"  {found.cleared} things in the way were put aside first")
    lines += [f"  seed {one.seed}: {one.failure}" for one in run.episodes if one.failure]
    return "\n".join(lines)


def _row(episode: Episode) -> dict[str, Any]:
    closing, placing = episode.closing, episode.placing
    return {
        "seed": episode.seed,
        "rung": episode.rung,
        "position_error_mm": closing and 1000 * closing.position_m,
        "yaw_error_deg": closing and float(np.degrees(closing.yaw_rad)),
        "place_error_mm": placing and 1000 * placing.position_m,
        "seen_error_mm": 1000 * episode.seen_error_m,
        "looks": episode.looks,
        "tries": episode.tries,
        "put_aside": episode.cleared,
        "pick_seconds": episode.pick_seconds,
        "ending": ending_of(episode),
        "failure": episode.failure,
    }


def _interval(count: int, of: int) -> list[float]:
    interval = wilson_interval(count, of)
    return [interval.low, interval.high]


def _scaled(spread: Spread, scale: float) -> dict[str, float]:
    return {"median": scale * spread.median, "p95": scale * spread.p95}
