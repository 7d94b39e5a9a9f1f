"""Drawings of what a calibration leaves unexplained."""

from typing import TYPE_CHECKING

import numpy as np

from vision_robot.calibrate.judgement.whiteness import normalised_residuals
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.report.calibration_findings import Findings
from vision_robot.report.figure import ACCENT, FAINT, INK, WARM, WIDTH_IN, draw, segments
from vision_robot.report.page import Figure
from vision_robot.report.picture_axes import PLATE, picture_axes, picture_height_in
from vision_robot.report.quantity import compact, listed
from vision_robot.types import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

__all__ = ["residual_histogram", "residual_map", "residual_scatter", "view_errors"]

MOST_MARKS = 4000
"""More marks than these on one drawing are only ink."""

MOST_BARS = 120
"""With more views than these each is a dot."""

LARGE = 4.0
"""Residuals longer than so many sigma are marked; noise alone makes one in 3000."""


def residual_map(findings: Findings) -> Figure:
    """Residuals where they were found, magnified."""
    camera = findings.result.camera
    seen, residuals, every = _thinned(findings.result)
    typical = max(findings.result.rms_px, 1e-9)
    magnified = _round(0.02 * camera.width / typical)
    large = _large(residuals, findings)
    reference = _round(2 * typical)

    def paint(canvas: "Canvas") -> None:
        axes = picture_axes(canvas, camera, room_above=0.05)
        for which, colour, width in ((~large, ACCENT, 0.7), (large, WARM, 1.0)):
            start = seen[which]
            segments(axes, start, start + magnified * residuals[which], colour=colour, width=width)
            segments(axes, start, colour=colour, width=width + 0.8)
        start = np.array([[0.0, -0.03 * camera.width]])
        end = start + np.array([[magnified * reference, 0.0]])
        segments(axes, start, end, colour=INK, width=1.6)
        axes.text(end[0, 0] + 0.012 * camera.width, end[0, 1], f"{reference:g} px", va="center_baseline")

    return Figure(
        draw(paint, height_in=picture_height_in(camera) + 0.05 * WIDTH_IN),
        alt=f"Residual vectors over the picture, magnified {magnified:g} times",
        caption=f"Residuals, predicted less seen, magnified {magnified:g} times, each from the dot where its "
        f"corner was seen; the bar above is {reference:g} px long. Neighbours that point the same way would "
        f"show a fault of the model.{_about_large(large)}{_about_thinning(every)}",
    )


def residual_scatter(findings: Findings) -> Figure:
    """All residuals about their common origin, with circles of the noise."""
    _, residuals, every = _thinned(findings.result)
    noise = findings.result.noise_px
    large = _large(residuals, findings)
    reach = 1.08 * max(float(np.abs(residuals).max()), 3.3 * noise, 1e-9)

    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        axes.set_aspect("equal")
        axes.axhline(0, color=FAINT, linewidth=0.6, zorder=0)
        axes.axvline(0, color=FAINT, linewidth=0.6, zorder=0)
        segments(axes, residuals[~large], colour=ACCENT, width=1.8)
        segments(axes, residuals[large], colour=WARM, width=2.8)
        turn = np.linspace(0, 2 * np.pi, 181)
        for k in (1, 2, 3):
            axes.plot(k * noise * np.cos(turn), k * noise * np.sin(turn), color=INK, linewidth=0.8)
            x = y = k * noise * float(np.sqrt(0.5))
            axes.text(x, y, f"{k} σ", fontsize=7.5, ha="center", va="center", bbox=PLATE)
        axes.set_xlim(-reach, reach)
        axes.set_ylim(reach, -reach)
        axes.set_xlabel("du [px]")
        axes.set_ylabel("dv [px]")

    return Figure(
        draw(paint, height_in=0.8 * WIDTH_IN),
        alt="Scatter of residuals du and dv with circles at one, two and three sigma",
        caption=f"The same residuals about one origin. Circles at 1, 2 and 3 times the noise σ = "
        f"{compact(noise)} px per axis; noise alone leaves 39 %, 86 % and 99 % inside them, here "
        f"{listed([_share(findings, k) for k in (1, 2, 3)])}.{_about_large(large)}{_about_thinning(every)}",
    )


def residual_histogram(findings: Findings) -> Figure:
    """Residuals per axis against the normal distribution."""
    scaled = np.concatenate(normalised_residuals(findings.result)) / max(findings.stated_noise_factor, 1e-12)
    reach = max(4.0, float(np.ceil(np.abs(scaled).max())))
    edges = np.linspace(-reach, reach, int(8 * reach) + 1)

    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        for column, name, colour in ((0, "du", ACCENT), (1, "dv", WARM)):
            count, _ = np.histogram(scaled[:, column], edges)
            density = count / max(len(scaled), 1) / np.diff(edges)
            axes.stairs(density, edges, color=colour, linewidth=1.0, label=name)
        x = np.linspace(-reach, reach, 241)
        axes.plot(x, np.exp(-x * x / 2) / np.sqrt(2 * np.pi), color=INK, linewidth=0.9, label="normal")
        axes.set_xlim(-reach, reach)
        axes.set_ylim(bottom=0)
        axes.set_xlabel("residual / σ")
        axes.set_ylabel("density")
        axes.legend(loc="upper right", handlelength=1.4)

    flat = scaled.ravel()
    within = 100 * float(np.mean(np.abs(flat) <= 2))
    return Figure(
        draw(paint, height_in=0.62 * WIDTH_IN),
        alt="Histograms of du and dv against the normal distribution",
        caption="Residuals per axis in units of their noise, beside the normal distribution. "
        f"{compact(within)} % lie "
        f"within 2 σ (normal: 95.4 %); the largest of {flat.size} is {compact(findings.largest_residual, 2)} "
        "σ.",
    )


def view_errors(findings: Findings) -> Figure:
    """Rms of each view."""
    result = findings.result
    rms = result.view_rms_px
    number = np.arange(1, len(rms) + 1)
    middle = float(np.median(rms))

    def paint(canvas: "Canvas") -> None:
        from matplotlib.ticker import MaxNLocator

        axes = canvas.add_subplot()
        colours = np.where(findings.outlying, WARM, ACCENT)
        if len(rms) <= MOST_BARS:
            axes.bar(number, rms, width=0.72, color=colours)
        else:
            for which, colour in ((~findings.outlying, ACCENT), (findings.outlying, WARM)):
                points = np.column_stack([number, rms])[which]
                segments(axes, points, colour=colour, width=2.2)
        axes.axhline(middle, color=INK, linewidth=0.8)
        axes.set_xlim(0.3, len(rms) + 0.7)
        axes.set_ylim(0, 1.18 * max(float(rms.max()), 1e-9))
        for i in np.flatnonzero(findings.outlying)[:8]:
            axes.annotate(
                f"{number[i]}",
                (number[i], rms[i]),
                (0, 2),
                textcoords="offset points",
                ha="center",
                color=WARM,
            )
        axes.xaxis.set_major_locator(MaxNLocator(nbins=10, integer=True, min_n_ticks=1))
        axes.set_xlabel("view")
        axes.set_ylabel("rms [px]")

    named = [f"{number[i]} ({result.corners[i].image})" for i in np.flatnonzero(findings.outlying)]
    apart = f" Much worse than the rest: view {listed(named, 4)}." if named else " No view stands out."
    return Figure(
        draw(paint, height_in=0.62 * WIDTH_IN),
        alt="Bars of the rms residual of each view",
        caption=f"Rms residual per point of each view; the line is the median, {compact(middle)} px.{apart}",
    )


def _thinned(result: CalibrationResult) -> tuple[Array, Array, int]:
    every = max(1, -(-result.corner_count // MOST_MARKS))
    seen = np.concatenate([view.pixels for view in result.corners])[::every]
    return seen, np.concatenate(result.residuals)[::every], every


def _large(residuals: Array, findings: Findings) -> Array:
    return np.linalg.norm(residuals, axis=1) > LARGE * max(findings.result.noise_px, 1e-12)


def _about_large(large: Array) -> str:
    if not large.any():
        return ""
    count = int(large.sum())
    return f" Orange: {count} longer than {LARGE:g} σ."


def _about_thinning(every: int) -> str:
    return f" One corner in {every} is drawn." if every > 1 else ""


def _share(findings: Findings, k: int) -> str:
    length = np.linalg.norm(np.concatenate(findings.result.residuals), axis=1)
    return f"{100 * float(np.mean(length <= k * findings.result.noise_px)):.0f} %"


def _round(value: float) -> float:
    """The nearest of 1, 2, 5, 10, ... below or at a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(step for step in (1, 2, 5) if step * power <= value * (1 + 1e-9)) * power)
