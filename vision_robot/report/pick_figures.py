"""Drawings of episodes: the ladder of success, errors and where they grow, how looks converge."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from vision_robot.evaluate.picking import distance_from_centre
from vision_robot.evaluate.statistics import Interval
from vision_robot.pick.episode import Episode, axis_angle
from vision_robot.pick.world import World
from vision_robot.report.figure import ACCENT, FAINT, INK, WARM, WIDTH_IN, draw, segments
from vision_robot.report.page import Figure
from vision_robot.report.quantity import compact
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

__all__ = ["convergence", "distribution", "growth", "ladder_chart", "plan_view"]

ROW_IN = 0.26


def ladder_chart(rungs: Mapping[str, Interval]) -> Figure:
    """A row for each rung: the share that got there, and its Wilson interval."""
    names, n = list(rungs), next(iter(rungs.values())).n

    def paint(canvas: "Canvas") -> None:
        canvas.subplots_adjust(left=0.75 / WIDTH_IN)
        axes = canvas.add_subplot()
        for row, share in enumerate(rungs.values()):
            axes.barh(row, 100 * share.value, height=0.62, color=ACCENT, alpha=0.28)
            axes.plot([100 * share.low, 100 * share.high], [row, row], color=INK, linewidth=1.4)
            axes.plot([100 * share.value], [row], "o", color=ACCENT, markersize=4)
        axes.set_yticks(range(len(names)), names)
        axes.set_ylim(len(names) - 0.5, -0.5)
        axes.set_xlim(0, 101)
        axes.set_xlabel("episodes that got at least so far [%]")

    return Figure(
        draw(paint, height_in=0.5 + ROW_IN * len(names)),
        alt="Share of episodes by rung of the ladder of success",
        caption=f"Each rung needs the one before. Lines are 95 % intervals (Wilson) of {n} episode(s).",
    )


def distribution(values: Mapping[str, Float[Array, "n"]], unit: str, caption: str) -> Figure:
    """Shares of episodes whose error is no larger than a bound, a line for each kind."""
    known = {name: np.sort(v[np.isfinite(v)]) for name, v in values.items()}
    known = {name: v for name, v in known.items() if len(v)}

    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        for (name, ordered), colour in zip(known.items(), (ACCENT, WARM, INK), strict=False):
            share = 100 * np.arange(len(ordered) + 1) / len(ordered)
            steps = np.concatenate([[0.0], ordered])
            axes.step(steps, share, where="post", color=colour, label=name)
            axes.plot([np.median(ordered)] * 2, [0, 50], color=colour, linewidth=0.7, linestyle=":")
        axes.axhline(95, color=FAINT, linewidth=0.6, zorder=0)
        axes.set_xlim(0, None)
        axes.set_ylim(0, 101)
        axes.set_xlabel(f"error [{unit}]")
        axes.set_ylabel("episodes [%]")
        if len(known) > 1:
            axes.legend(loc="lower right")

    tied = unit if unit == "°" else f" {unit}"
    medians = ", ".join(
        f"{name} {compact(float(np.median(v)))}{tied} (95 % within {compact(float(np.percentile(v, 95)))})"
        for name, v in known.items()
    )
    return Figure(
        draw(paint, height_in=2.6),
        alt=f"Shares of episodes by error in {unit}",
        caption=f"{caption} Dotted lines are medians: {medians}.",
    )


def plan_view(offsets_m: Mapping[str, Float[Array, "n 2"]]) -> Figure:
    """Errors seen from above, with mean and two-sigma ellipse."""
    shown = {name: 1000 * rows for name, rows in offsets_m.items() if len(rows)}
    reach = 1.12 * max(float(np.abs(rows).max()) for rows in shown.values())
    turn = np.linspace(0, 2 * np.pi, 61)
    circle = np.stack([np.cos(turn), np.sin(turn)])

    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        axes.set_aspect("equal")
        axes.axhline(0, color=FAINT, linewidth=0.6, zorder=0)
        axes.axvline(0, color=FAINT, linewidth=0.6, zorder=0)
        for (name, rows), colour in zip(shown.items(), (ACCENT, WARM), strict=False):
            segments(axes, rows, colour=colour, width=2.2)
            middle = rows.mean(axis=0)
            axes.plot(*middle, "+", color=colour, markersize=8, markeredgewidth=1.4, label=name)
            if len(rows) > 2:
                values, vectors = np.linalg.eigh(np.cov(rows.T))
                half_axes = 2 * np.sqrt(np.maximum(values, 0))[:, None]
                axes.plot(*(middle[:, None] + vectors @ (half_axes * circle)), color=colour)
        axes.set_xlim(-reach, reach)
        axes.set_ylim(-reach, reach)
        axes.set_xlabel("x of the station [mm]")
        axes.set_ylabel("y of the station [mm]")
        if len(shown) > 1:
            axes.legend(loc="upper right")

    means = "; ".join(
        f"{name}: mean ({compact(rows[:, 0].mean(), 2)}, {compact(rows[:, 1].mean(), 2)}) mm, "
        f"sigma ({_sigma(rows[:, 0])}, {_sigma(rows[:, 1])}) mm"
        for name, rows in shown.items()
    )
    return Figure(
        draw(paint, height_in=0.86 * WIDTH_IN),
        alt="Position errors seen from above, with ellipses",
        caption="Errors seen from above: a dot for each episode, a cross at the mean (the bias), an "
        "ellipse of two "
        f"sigma (the spread). {means}.",
    )


def _sigma(column: Float[Array, "n"]) -> str:
    return compact(float(column.std(ddof=1)), 2) if len(column) > 1 else "–"


def growth(world: World, episodes: Sequence[Episode]) -> tuple[Figure, ...]:
    """Position error at closing against where the thing lay and how it was turned; failures marked."""
    closed = [one for one in episodes if one.closing]
    error = np.array([1000 * one.closing.position_m for one in closed if one.closing])
    failed = np.array([not one.lifted for one in closed], dtype=bool)
    far = np.array([distance_from_centre(world, one) for one in closed])
    yaw = np.array([np.degrees(axis_angle(one.station_from_object.rotation, 0)) % 180 for one in closed])
    return (
        _scatter(far, error, failed, "distance from the picture's middle [half diagonals]", "distance"),
        _scatter(yaw, error, failed, "direction of the thing's axis [°]", "direction"),
    )


def _scatter(
    x: Float[Array, "n"], error_mm: Float[Array, "n"], failed: Array, label: str, name: str
) -> Figure:
    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        segments(axes, np.stack([x, error_mm], axis=1)[~failed], colour=ACCENT, width=2.4)
        if failed.any():
            axes.plot(x[failed], error_mm[failed], "x", color=WARM, markersize=5)
        axes.set_xlim(*_room(x))
        axes.set_ylim(0, 1.08 * max(float(error_mm.max()), 1e-6))
        axes.set_xlabel(label)
        axes.set_ylabel("error at closing [mm]")

    crosses = " Crosses are episodes that did not lift." if failed.any() else ""
    return Figure(
        draw(paint, height_in=2.4),
        alt=f"Position error at closing against {name}",
        caption=f"Position error at closing against {name}.{crosses}",
    )


def _room(x: Float[Array, "n"]) -> tuple[float, float]:
    low, high = float(np.nanmin(x)), float(np.nanmax(x))
    edge = 0.04 * max(high - low, 1e-6)
    return low - edge, high + edge


def convergence(episodes: Sequence[Episode]) -> Figure | None:
    """Errors over the looks of a closed loop, seen and true; None where no loop was closed."""
    courses = [one.course for one in episodes if one.course]
    if not courses:
        return None
    longest = max(len(course) for course in courses)
    seen, true = (np.full((len(courses), longest), np.nan) for _ in range(2))
    for row, course in enumerate(courses):
        seen[row, : len(course)] = [1000 * look.error_m for look in course]
        true[row, : len(course)] = [1000 * look.true_m for look in course]
    number = np.arange(1, longest + 1)

    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        for row in true[:40]:
            axes.plot(number, np.maximum(row, 1e-3), color=FAINT, linewidth=0.5)
        for rows, colour, name in ((seen, WARM, "asked for"), (true, ACCENT, "true")):
            count = np.isfinite(rows).sum(axis=0)
            known = count >= max(1, len(courses) // 4)
            middle = [float(np.nanmedian(rows[:, k])) for k in np.flatnonzero(known)]
            axes.plot(number[known], np.maximum(middle, 1e-3), "o-", color=colour, markersize=2.5, label=name)
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.set_xticks(number)
        axes.set_xlabel("look")
        axes.set_ylabel("error [mm]")
        axes.legend(loc="upper right")

    return Figure(
        draw(paint, height_in=2.6),
        alt="Errors over the looks of the closed loop",
        caption=f"Convergence of {len(courses)} closed loop(s): the step that a look asked for, and the "
        "true error "
        "of the tool over the thing when it looked; medians over those still looking, a pale line for "
        "each episode.",
    )
