"""Running the episodes that `vr pick` asks for."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from vision_robot.errors import BadParameter
from vision_robot.evaluate.error_budget import ErrorBudget
from vision_robot.pick.closed_loop import LAWS
from vision_robot.pick.episode import Episode
from vision_robot.pick.episodes import Plan, run_episode
from vision_robot.pick.world import World
from vision_robot_cli.output import progress
from vision_robot_cli.pick_budget import budget_of, in_processes
from vision_robot_cli.pick_cell import CellWish, colour_names, world_of

__all__ = ["PickRun", "pick_run"]

CLOSED = "closed"


@dataclass(frozen=True)
class PickRun:
    """What was asked and what happened."""

    plan: Plan
    world: World
    scene: str
    faults: Sequence[str]
    episodes: Sequence[Episode]
    budget: ErrorBudget | None


def pick_run(
    count: int,
    loop: str,
    tracker: str,
    options: Sequence[str],
    wish: CellWish,
    tries: int,
    with_budget: bool,
    workers: int,
    seed: int,
) -> PickRun:
    """All episodes, in the order of their seeds."""
    if count < 1:
        raise BadParameter("--episodes", count, "a whole number from 1 on")
    if workers < 1:
        raise BadParameter("--workers", workers, "a whole number from 1 on")
    world = world_of(wish, seed)
    given = _options(options)
    if tracker == "rgb" and not given:
        given = {"color": colour_names(world.design.items)}  # what the cell's things are
    plan = Plan(tracker, given, next(iter(LAWS)) if loop == CLOSED else loop, tries=tries)
    if with_budget and world.design.belt is not None:
        raise BadParameter("--budget", "on a belt", "left out: the budget is that of things that lie still")
    seeds = range(seed, seed + count)
    episodes = list(progress(_episodes(world, plan, seeds, workers), "picking", total=count))
    budget = None
    if with_budget:
        budget = budget_of(world, plan, seeds, workers)
    return PickRun(plan, world, wish.scene, wish.faults, episodes, budget)


def _episodes(world: World, plan: Plan, seeds: Sequence[int], workers: int) -> Iterable[Episode]:
    return in_processes(partial(run_episode, world, plan), seeds, workers)


def _options(words: Sequence[str]) -> Mapping[str, Any]:
    given = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals:
            raise BadParameter("--set", word, "a name and a value, such as color=red")
        given[name.strip().rpartition(".")[2]] = value.strip()
    return given
