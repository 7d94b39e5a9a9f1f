"""The page of episodes of pick and place."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from vision_robot.evaluate.error_budget import ErrorBudget
from vision_robot.evaluate.picking import closing_offsets_m, iso_9283, ladder, placing_offsets_m
from vision_robot.pick.episode import Episode
from vision_robot.pick.episodes import OPEN, Plan
from vision_robot.pick.film import Still
from vision_robot.pick.summary import Spread, summary_of
from vision_robot.pick.world import World
from vision_robot.report.page import Facts, Figures, Footer, Page, Paragraph, Part, Remarks, Section
from vision_robot.report.pick_budget import budget_parts
from vision_robot.report.pick_figures import convergence, distribution, growth, ladder_chart, plan_view
from vision_robot.report.pick_stills import film_strip
from vision_robot.report.pick_tables import asked, breakdown, conditions, failed, iso_table
from vision_robot.report.quantity import compact
from vision_robot.report.versions import versions

__all__ = ["PickStory", "error_parts", "failure_parts", "pick_page", "picks_piece"]

TELLING = ("seen", "close", "put down")
"""Phases at whose ends a failure can be seen, besides the last picture."""

SHORT = ("seen", "down", "lift")
"""Phases that a longer story shows of an episode, besides the loop's own and the last picture."""

LOW_SHARE = 0.9
"""Grasp success under which a page warns."""


@dataclass(frozen=True)
class PickStory:
    """What was asked, what happened, and the pictures of it."""

    plan: Plan
    world: World
    faults: tuple[str, ...]
    episodes: tuple[Episode, ...]
    budget: ErrorBudget | None = None
    stills: Mapping[int, Sequence[Still]] = field(default_factory=dict)
    """By seed: of failures, or of one that went well."""


def pick_page(story: PickStory, *, command: str = "", seed: int | None = None) -> Page:
    """Everything about a run of episodes; failures stand first.

    Args:
        story: The run.
        command: Command line that makes the page again.
        seed: First seed.
    """
    sections = [Section("Result", (_facts(story), Remarks(_remarks(story))))]
    if any(not one.placed for one in story.episodes):
        sections.append(Section("What failed", failure_parts(story)))
    sections.append(Section("How far it got", (Figures((ladder_chart(ladder(story.episodes)),)),)))
    if any(one.closing for one in story.episodes):
        sections.append(Section("How well it hit", error_parts(story)))
        where = (Figures(growth(story.world, story.episodes)), breakdown(story.world, story.episodes))
        sections.append(Section("Where it is worse", where))
    looks = convergence(story.episodes)
    if looks is not None:
        sections.append(Section("Closing the loop", (Figures((looks,)),)))
    if story.budget is not None:
        sections.append(Section("Where the millimetres come from", budget_parts(story.budget)))
    well = [one for one in story.episodes if one.placed and one.seed in story.stills]
    if well:
        sections.append(
            Section("An episode", (film_strip(story.stills[well[0].seed], f"seed {well[0].seed}"),))
        )
    sections.append(
        Section("What was asked", (asked(story.plan, story.world, story.faults, story.episodes),))
    )
    return Page("Pick and place", _summary(story), tuple(sections), Footer(versions(), seed, command))


def _summary(story: PickStory) -> str:
    n, plan = len(story.episodes), story.plan
    loop = "open loop" if plan.loop == OPEN else f"loop closed by {plan.loop}"
    faults = f", with {', '.join(story.faults)}" if story.faults else ""
    found = summary_of(story.episodes)
    return (
        f"{n} episode(s) in physics, {loop}, by what tracker {plan.tracker} sees through a calibrated "
        f"camera{faults}. "
        f"{found.reached_rung['lifted']} grasped, {found.reached_rung['placed']} placed within "
        f"{1000 * plan.tolerances.place_m:g} mm and {np.degrees(plan.tolerances.place_yaw_rad):g}°."
    )


def _facts(story: PickStory) -> Facts:
    found, rungs = summary_of(story.episodes), ladder(story.episodes)

    def share(rung: str) -> str:
        interval = rungs[rung]
        return f"95 % interval {100 * interval.low:.1f} to {100 * interval.high:.1f} %"

    def spread(name: str, of: Spread, scale: float, unit: str) -> tuple[str, str, str]:
        if not np.isfinite(of.median):
            return name, "–", "never came so far"
        about = f"median; 95 % within {compact(scale * of.p95)}{unit}"
        return name, f"{compact(scale * of.median)}{unit}", about

    degrees = 180 / np.pi
    return Facts(
        (
            ("grasped and held", f"{100 * rungs['lifted'].value:.1f} %", share("lifted")),
            ("placed", f"{100 * rungs['placed'].value:.1f} %", share("placed")),
            spread("position at closing", found.position_m, 1000, " mm"),
            spread("yaw at closing", found.yaw_rad, degrees, "°"),
            spread("position after placing", found.placing_m, 1000, " mm"),
            spread("yaw after placing", found.placing_yaw_rad, degrees, "°"),
            spread("time", found.seconds, 1, " s"),
            spread("looks", found.looks, 1, ""),
        )
    )


def _remarks(story: PickStory) -> tuple[tuple[str, str], ...]:
    rungs, n = ladder(story.episodes), len(story.episodes)
    lifted = rungs["lifted"]
    tone = "good" if lifted.low >= LOW_SHARE else ("caution" if lifted.high < LOW_SHARE else "note")
    remarks = [
        (
            tone,
            f"{100 * lifted.value:.1f} % of {n} grasps held; 95 % interval "
            f"{100 * lifted.low:.1f} to {100 * lifted.high:.1f} %.",
        )
    ]
    if story.plan.loop != OPEN:
        blind = sum(1 for one in story.episodes if one.seen and not one.course)
        if blind:
            remarks.append(
                (
                    "caution",
                    f"In {blind} of {n} episodes the loop was not closed: the label on the hand was not "
                    "seen whole, "
                    "and the arm went where the thing was seen at first.",
                )
            )
    offsets = 1000 * closing_offsets_m(story.episodes)
    if len(offsets) > 2:
        bias, spread = (
            np.linalg.norm(offsets.mean(axis=0)),
            np.sqrt(np.trace(np.cov(offsets.T)) / len(offsets)),
        )
        if bias > 3 * spread:
            remarks.append(
                (
                    "caution",
                    f"The tool closes {compact(float(bias))} mm to one side on average, far more than the "
                    "spread "
                    "explains: calibrate the cell again, or close the loop.",
                )
            )
    return tuple(remarks)


def failure_parts(story: PickStory) -> tuple[Part, ...]:
    """Each failure with its reason and pictures of it."""
    parts: list[Part] = [failed(story.plan, story.episodes)]
    shown = [one for one in story.episodes if not one.placed and one.seed in story.stills]
    for one in shown:
        stills = story.stills[one.seed]
        told = [still for still in stills[:-1] if still.phase in TELLING] + [stills[-1]]
        parts.append(film_strip(told, f"seed {one.seed}"))
    left_out = sum(not one.placed for one in story.episodes) - len(shown)
    if left_out:
        film = "'vr pick --episodes 1 --seed N --video film.mp4' films any of them"
        parts.append(Paragraph(f"Pictures of {left_out} more are left out; {film}."))
    return tuple(parts)


def error_parts(story: PickStory) -> tuple[Part, ...]:
    """Distributions of errors, errors from above, and ISO 9283."""
    closing = [one.closing for one in story.episodes if one.closing]
    placing = [one.placing for one in story.episodes if one.placing]
    position = {
        "at closing": 1000 * np.array([miss.position_m for miss in closing]),
        "after placing": 1000 * np.array([miss.position_m for miss in placing]),
    }
    yaw = {
        "at closing": np.degrees(np.abs([miss.yaw_rad for miss in closing])),
        "after placing": np.degrees(np.abs([miss.yaw_rad for miss in placing])),
    }
    offsets = {
        "tool at closing": closing_offsets_m(story.episodes),
        "thing placed": placing_offsets_m(story.episodes),
    }
    figures = (
        distribution(position, "mm", "Position errors in the plane of the table."),
        distribution(yaw, "°", "Errors of direction."),
        plan_view(offsets),
    )
    return (Figures(figures), iso_table(iso_9283(closing), iso_9283(placing)))


def picks_piece(stories: Mapping[str, PickStory]) -> tuple[Part, ...]:
    """What a longer story tells of picking: each condition with its figures, and films on a strip."""
    parts: list[Part] = [conditions({name: story.episodes for name, story in stories.items()})]
    for name, story in stories.items():
        for seed, stills in story.stills.items():
            told = [still for still in stills[:-1] if still.phase in (*SHORT, story.plan.loop)]
            parts.append(film_strip([*told, stills[-1]], f"{name}, seed {seed}"))
    offsets = {name: closing_offsets_m(story.episodes) for name, story in stories.items()}
    if any(len(rows) for rows in offsets.values()):
        parts.append(Figures((plan_view(offsets),)))
    return tuple(parts)
