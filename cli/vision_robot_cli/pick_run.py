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
from vision_robot.pick.faults import FAULTS, with_fault, with_lens
from vision_robot.pick.world import World, ordinary_world
from vision_robot_cli.output import progress
from vision_robot_cli.pick_budget import budget_of, in_processes
from vision_robot_cli.quantities import quantity

__all__ = ["PickRun", "pick_run"]

CLOSED = "closed"


@dataclass(frozen=True)
class PickRun:
    """What was asked and what happened."""

    plan: Plan
    world: World
    faults: Sequence[str]
    episodes: Sequence[Episode]
    budget: ErrorBudget | None


def pick_run(
    count: int,
    loop: str,
    tracker: str,
    options: Sequence[str],
    faults: Sequence[str],
    with_budget: bool,
    workers: int,
    seed: int,
) -> PickRun:
    """All episodes, in the order of their seeds."""
    if count < 1:
        raise BadParameter("--episodes", count, "a whole number from 1 on")
    if workers < 1:
        raise BadParameter("--workers", workers, "a whole number from 1 on")
    given = _options(options)
    if tracker == "rgb" and not given:
        given = {"color": "red"}  # what the cell's rod is
    plan = Plan(tracker, given, next(iter(LAWS)) if loop == CLOSED else loop)
    world = ordinary_world()
    for one in faults:
        world = _faulty(world, one)
    seeds = range(seed, seed + count)
    episodes = list(progress(_episodes(world, plan, seeds, workers), "picking", total=count))
    budget = None
    if with_budget:
        budget = budget_of(world, plan, seeds, workers)
    return PickRun(plan, world, faults, episodes, budget)


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


def _faulty(world: World, text: str) -> World:
    name, _, value = text.partition("=")
    name = name.strip()
    if name == "lens":
        return with_lens(world, value.strip())
    unit = FAULTS[name].unit if name in FAULTS else ""
    return with_fault(world, name, quantity(value, unit, f"--fault {name}"))
