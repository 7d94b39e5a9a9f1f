"""Covariance ellipses on a plane, magnified, with errors beside them where the truth is known."""

from typing import TYPE_CHECKING

import numpy as np

from vision_robot.report.figure import ACCENT, WARM, WIDTH_IN, draw, segments
from vision_robot.report.page import Figure
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

__all__ = ["ellipses"]


def ellipses(
    positions_mm: Float[Array, "n 2"],
    covariance_mm2: Float[Array, "n 2 2"],
    names: tuple[str, str],
    *,
    caption: str,
    errors_mm: Float[Array, "n 2"] | None = None,
) -> Figure:
    """Two-sigma ellipses at their places; errors as lines from the middle of theirs."""
    values, vectors = np.linalg.eigh(covariance_mm2)
    lengths = 2 * np.sqrt(np.maximum(values, 0))
    area = np.ptp(positions_mm, axis=0)
    spacing = float(np.sqrt(max(area[0], 1e-9) * max(area[1], 1e-9) / max(len(positions_mm), 1)))
    magnified = _round(0.45 * max(spacing, 1e-9) / max(float(np.quantile(lengths[:, 1], 0.9)), 1e-12))
    if len(positions_mm) == 1:
        magnified = 1.0  # alone it has the whole drawing
    turn = np.linspace(0, 2 * np.pi, 41)
    circle = np.stack([np.cos(turn), np.sin(turn)])

    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        axes.set_aspect("equal")
        for place, length, axis in zip(positions_mm, lengths, vectors, strict=True):
            outline = place + magnified * ((axis * length) @ circle).T
            axes.plot(*outline.T, color=ACCENT, linewidth=0.7)
        segments(axes, positions_mm, colour=ACCENT, width=1.4)
        if errors_mm is not None:
            segments(axes, positions_mm, positions_mm + magnified * errors_mm, colour=WARM, width=1.1)
        axes.margins(0.06)
        axes.autoscale_view()
        axes.set_xlabel(f"{names[0]} [mm]")
        axes.set_ylabel(f"{names[1]} [mm]")

    also = " Orange lines are the errors to the truth, magnified alike." if errors_mm is not None else ""
    return Figure(
        draw(paint, height_in=0.8 * WIDTH_IN),
        alt="Covariance ellipses, magnified",
        caption=f"{caption} Ellipses are two sigma, magnified {magnified:g} times.{also}"
        if magnified != 1
        else f"{caption} The ellipse is two sigma.",
    )


def _round(value: float) -> float:
    power = 10.0 ** np.floor(np.log10(max(value, 1e-12)))
    return float(f"{power * max(step for step in (1, 2, 5) if step * power <= value * 1.0000001):.3g}")
