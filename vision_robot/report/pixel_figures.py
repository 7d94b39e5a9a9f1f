"""Residuals over a picture and about their origin, for any set of points."""

from typing import TYPE_CHECKING

import numpy as np

from vision_robot.geometry import Camera
from vision_robot.report.figure import ACCENT, FAINT, INK, WIDTH_IN, draw, segments
from vision_robot.report.page import Figure
from vision_robot.report.picture_axes import PLATE, picture_axes, picture_height_in
from vision_robot.report.quantity import compact
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

__all__ = ["residual_arrows", "scatter_rings"]

MOST_MARKS = 4000


def residual_arrows(
    camera: Camera, pixels: Float[Array, "n 2"], residuals: Float[Array, "n 2"], *, title: str = ""
) -> Figure:
    """Residuals where they were found, magnified."""
    every = max(1, -(-len(pixels) // MOST_MARKS))
    seen, off = pixels[::every], residuals[::every]
    typical = max(float(np.sqrt(np.mean(np.sum(residuals**2, axis=1)))), 1e-9)
    magnified = _round(0.025 * camera.width / typical)
    reference = _round(2 * typical)

    def paint(canvas: "Canvas") -> None:
        axes = picture_axes(canvas, camera, room_above=0.05)
        segments(axes, seen, seen + magnified * off, colour=ACCENT, width=0.8)
        segments(axes, seen, colour=ACCENT, width=1.6)
        start = np.array([[0.0, -0.03 * camera.width]])
        end = start + np.array([[magnified * reference, 0.0]])
        segments(axes, start, end, colour=INK, width=1.6)
        axes.text(end[0, 0] + 0.012 * camera.width, end[0, 1], f"{reference:g} px", va="center_baseline")

    named = f"{title}: " if title else ""
    return Figure(
        draw(paint, height_in=picture_height_in(camera) + 0.05 * WIDTH_IN),
        alt=f"{named}residual vectors over the picture",
        caption=f"{named}residuals, predicted less seen, magnified {magnified:g} times; "
        f"{compact(typical)} px rms. "
        f"The bar above is {reference:g} px long.",
    )


def scatter_rings(
    values: Float[Array, "n 2"], sigma: float, unit: str, names: tuple[str, str], *, alt: str, caption: str
) -> Figure:
    """Errors about their origin with circles of one, two and three sigma."""
    reach = 1.08 * max(float(np.abs(values).max()), 3.3 * sigma, 1e-12)
    every = max(1, -(-len(values) // MOST_MARKS))

    def paint(canvas: "Canvas") -> None:
        from matplotlib.ticker import MaxNLocator

        axes = canvas.add_subplot()
        axes.set_aspect("equal")
        axes.xaxis.set_major_locator(MaxNLocator(nbins=5))
        axes.axhline(0, color=FAINT, linewidth=0.6, zorder=0)
        axes.axvline(0, color=FAINT, linewidth=0.6, zorder=0)
        segments(axes, values[::every], colour=ACCENT, width=2.0)
        turn = np.linspace(0, 2 * np.pi, 181)
        for k in (1, 2, 3):
            axes.plot(k * sigma * np.cos(turn), k * sigma * np.sin(turn), color=INK, linewidth=0.8)
            place = k * sigma * float(np.sqrt(0.5))
            axes.text(place, place, f"{k} σ", fontsize=7.5, ha="center", va="center", bbox=PLATE)
        axes.set_xlim(-reach, reach)
        axes.set_ylim(-reach, reach)
        axes.set_xlabel(f"{names[0]} [{unit}]")
        axes.set_ylabel(f"{names[1]} [{unit}]")

    return Figure(draw(paint, height_in=0.8 * WIDTH_IN), alt=alt, caption=caption)


def _round(value: float) -> float:
    """The nearest of 1, 2, 5, 10, ... below."""
    power = 10.0 ** np.floor(np.log10(max(value, 1e-12)))
    return float(f"{power * max(step for step in (1, 2, 5) if step * power <= value * 1.0000001):.3g}")
