"""Tables of episodes: what was asked, what failed, ISO 9283, and the breakdown."""

from collections.abc import Mapping, Sequence

import numpy as np

from vision_robot.evaluate.picking import Group, by_distance, by_thing, by_yaw
from vision_robot.evaluate.pose_accuracy import PoseAccuracy
from vision_robot.evaluate.statistics import Interval
from vision_robot.pick.episode import RUNGS, Episode
from vision_robot.pick.episodes import OPEN, Plan
from vision_robot.pick.summary import summary_of
from vision_robot.pick.world import World
from vision_robot.report.page import Table
from vision_robot.report.quantity import compact

__all__ = ["asked", "breakdown", "conditions", "failed", "iso_table"]

NEXT = {
    "": "the tracker said nothing",
    "seen": "the tool was too far off when the fingers closed",
    "reached": "the fingers closed, but not both on the thing",
    "gripped": "it slipped before it was up and held",
    "lifted": "put down outside the tolerance",
}
"""Rung that was reached last -> what went wrong then, where no error tells."""


def asked(plan: Plan, world: World, faults: Sequence[str], episodes: Sequence[Episode]) -> Table:
    """How the episodes were run."""
    options = ", ".join(f"{name}={value}" for name, value in plan.options.items())
    camera, tolerances = world.view.camera, plan.tolerances
    size = " × ".join(f"{1000 * side:g}" for side in world.design.items[0].size_m)
    things = ", ".join(dict.fromkeys(one.thing for one in episodes if one.thing))
    rows = (
        ("loop", plan.loop),
        ("tracker", f"{plan.tracker}{f' ({options})' if options else ''}"),
        ("faults", ", ".join(faults) or "none"),
        ("thing", f"{things}, the first {size} mm"),
        ("arm", f"{world.arm.name}, {len(world.arm)} joints"),
        ("camera", f"{camera.width} × {camera.height} px, {camera.model}, fitted as {world.lens}"),
        ("reached", f"tool within {1000 * tolerances.reach_m:g} mm of the thing when the fingers close"),
        ("gripped", "both fingers touch it"),
        ("lifted", f"up by {1000 * tolerances.lift_m:g} mm and held for {tolerances.hold_s:g} s"),
        (
            "placed",
            f"at rest within {1000 * tolerances.place_m:g} mm and "
            f"{np.degrees(tolerances.place_yaw_rad):g}° of its goal",
        ),
        (
            "seeds",
            f"{episodes[0].seed} to {episodes[-1].seed}" if len(episodes) > 1 else str(episodes[0].seed),
        ),
    )
    return Table(("", ""), rows, "How the episodes were run, and what counts as what.")


def failed(plan: Plan, episodes: Sequence[Episode]) -> Table:
    """One row for each episode that did not place its thing."""
    rows = []
    for one in episodes:
        if one.placed:
            continue
        closing, placing = one.closing, one.placing
        rows.append(
            (
                str(one.seed),
                one.rung or "not seen",
                one.failure or _why(plan, one),
                compact(1000 * one.seen_error_m) if one.seen else "–",
                compact(1000 * closing.position_m) if closing else "–",
                compact(1000 * placing.position_m) if placing else "–",
            )
        )
    return Table(
        ("seed", "last rung", "why", "seen off [mm]", "closed off [mm]", "placed off [mm]"),
        tuple(rows),
        f"Episodes that did not get to the last of {len(RUNGS)} rungs, all of them.",
        numeric=frozenset({0, 3, 4, 5}),
    )


def _why(plan: Plan, episode: Episode) -> str:
    blind = plan.loop != OPEN and episode.seen and not episode.course
    return f"{'the label on the hand was hidden; ' if blind else ''}{NEXT[episode.rung]}"


def iso_table(closing: PoseAccuracy | None, placing: PoseAccuracy | None) -> Table:
    """Accuracy and repeatability of the closing and of the placed pose."""
    rows = [
        (
            name,
            compact(1000 * found.accuracy_m),
            compact(1000 * found.repeatability_m),
            compact(np.degrees(found.yaw_accuracy_rad)),
            compact(np.degrees(found.yaw_repeatability_rad)),
            str(found.n),
        )
        for name, found in (("tool at closing", closing), ("thing placed", placing))
        if found is not None
    ]
    return Table(
        ("pose", "accuracy AP [mm]", "repeatability RP [mm]", "AP of yaw [°]", "RP of yaw [°]", "n"),
        tuple(rows),
        "As ISO 9283 defines them, in the plane: accuracy is the bias of the mean, repeatability mean "
        "plus three "
        "sigma of the distances from it. Poses are taken relative to the commanded one; the standard asks "
        "for 30.",
        numeric=frozenset({1, 2, 3, 4, 5}),
    )


def breakdown(world: World, episodes: Sequence[Episode]) -> Table:
    """Success and errors by where the thing lay, how it was turned, and what it was."""
    rows = [
        *_rows("distance from the picture's middle", by_distance(world, episodes)),
        *_rows("direction of its axis", by_yaw(episodes)),
        *_rows("thing", by_thing(episodes)),
    ]
    return Table(
        ("by", "", "episodes", "grasped [%]", "95 %", "position [mm]", "95 % within", "yaw [°]"),
        tuple(rows),
        "Grasps and median errors at closing by group; distances in half diagonals of the picture.",
        numeric=frozenset({2, 3, 5, 6, 7}),
    )


def _rows(by: str, groups: Sequence[Group]) -> list[tuple[str, ...]]:
    return [
        (
            by if k == 0 else "",
            group.name,
            str(group.grasps.n),
            f"{100 * group.grasps.value:.1f}",
            _percent(group.grasps),
            compact(1000 * group.position_m.median),
            compact(1000 * group.position_m.p95),
            compact(np.degrees(group.yaw_rad.median)),
        )
        for k, group in enumerate(groups)
    ]


def _percent(interval: Interval) -> str:
    return f"{100 * interval.low:.0f} to {100 * interval.high:.0f}"


def conditions(episodes: Mapping[str, Sequence[Episode]]) -> Table:
    """Several conditions side by side."""
    rows = []
    for name, some in episodes.items():
        found = summary_of(some)
        rows.append(
            (
                name,
                str(found.episodes),
                str(found.reached_rung["lifted"]),
                str(found.reached_rung["placed"]),
                compact(1000 * found.position_m.median),
                compact(np.degrees(found.yaw_rad.median)),
                compact(1000 * found.placing_m.median),
                compact(found.seconds.median),
            )
        )
    return Table(
        ("", "episodes", "held", "placed", "closed off [mm]", "turned [°]", "placed off [mm]", "time [s]"),
        tuple(rows),
        "Episodes of the same seeds under each condition; medians.",
        numeric=frozenset(range(1, 8)),
    )
