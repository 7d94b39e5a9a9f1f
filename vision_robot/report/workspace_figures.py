"""Drawings of where an arm reaches."""

from typing import TYPE_CHECKING

import numpy as np

from vision_robot.arm.workspace import Slice, Workspace
from vision_robot.report.figure import FAINT, INK, WIDTH_IN, draw
from vision_robot.report.page import Figure
from vision_robot.types import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

__all__ = ["workspace_figures"]

LEVELS = 10


def workspace_figures(found: Workspace) -> tuple[Figure, Figure]:
    """From above at one height, and upright through the base."""
    height = 1000 * found.height_m
    best = float(
        max(np.nanmax(part.manipulability, initial=0.0) for part in (found.level, found.upright)) or 1.0
    )
    share = 100 * found.level.reached.mean()
    cell = np.prod([np.diff(axis[:2])[0] for axis in (found.level.across_m, found.level.up_m)])
    area = float(found.level.reached.sum() * cell)
    return (
        Figure(
            draw(lambda canvas: _paint(canvas, found.level, best, "y [mm]"), height_in=0.94 * WIDTH_IN),
            alt="Reachable places seen from above, shaded by manipulability",
            caption=f"From above, the tool pointing down {height:.0f} mm above the base: {area:.3f} m² can "
            f"be reached ({share:.0f} % of the square). Shaded by how well the tool moves there in every "
            "direction (Yoshikawa's measure, share of the best); blank is out of reach, + is the base.",
        ),
        Figure(
            draw(
                lambda canvas: _paint(canvas, found.upright, best, "z [mm]", level_mm=height),
                height_in=0.94 * WIDTH_IN,
            ),
            alt="Reachable places in the upright plane through the base, shaded by manipulability",
            caption="Upright plane through the base along x, the tool pointing down; same shading. The "
            "dotted line is the height of the other drawing.",
        ),
    )


def _paint(canvas: "Canvas", part: Slice, best: float, up: str, level_mm: float | None = None) -> None:
    axes = canvas.add_subplot()
    x, y = 1000 * part.across_m, 1000 * part.up_m
    bands = axes.contourf(x, y, _filled(part) / best, levels=np.linspace(0, 1, LEVELS + 1), cmap="Blues")
    reached = part.reached.astype(float)
    axes.contourf(x, y, reached, levels=[-0.5, 0.5], colors=["white"])
    # Where the arm is stretched the measure is zero and nearly white: the border says where reach ends.
    axes.contour(x, y, reached, levels=[0.5], colors=[INK], linewidths=0.7)
    axes.plot(0, 0, "+", color=INK, markersize=6)
    if level_mm is not None:
        axes.axhline(level_mm, color=INK, linewidth=0.8, linestyle=(0, (1, 2)))
    axes.set_aspect("equal")
    axes.set_ylim(*_extent(y, np.any(part.reached, axis=1), x[-1] - x[0]))
    axes.set_xlabel("x [mm]")
    axes.set_ylabel(up)
    axes.grid(color=FAINT, linewidth=0.3)
    bar = canvas.colorbar(bands, ax=axes, shrink=0.8, pad=0.02)
    bar.set_label("manipulability, share of the best")
    bar.outline.set_linewidth(0.4)  # type: ignore[union-attr]


def _filled(part: Slice) -> Array:
    """The measure with the value of the nearest place that is reached where there is none.

    So that bands run up to the border instead of ending half a cell before it.
    """
    from scipy.ndimage import distance_transform_edt

    if not part.reached.any():
        return np.zeros(part.reached.shape)
    nearest = np.asarray(distance_transform_edt(~part.reached, return_distances=False, return_indices=True))
    return part.manipulability[nearest[0], nearest[1]]


def _extent(y: Array, rows: Array, width: float) -> tuple[float, float]:
    """What to show upright: where something is reached and the base, no more than a square."""
    used = np.concatenate([y[rows], [0.0]])
    low, high = used.min(), used.max()
    room = 0.08 * width
    return max(low - room, y[0]), min(high + room, y[-1])
