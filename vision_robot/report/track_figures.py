"""Drawings of tracks: paths in the picture and on the plane, places, speeds and areas over time."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from vision_robot.report.figure import WIDTH_IN, draw, view_colours
from vision_robot.report.page import Figure
from vision_robot.report.picture_axes import PLATE
from vision_robot.track.history import Path
from vision_robot.types import Array, Float, Image

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

__all__ = ["area_plot", "path_figure", "path_picture", "place_plots", "speed_plot"]

PICTURE_PX = 480
"""Width of the frame under the paths: it is only there to find one's way."""

MOST_NAMED = 12
"""Objects named in a drawing; with more, their names are only clutter."""


def path_picture(first: Image, paths: Sequence[Path]) -> Figure:
    """All paths over the first frame."""
    import cv2

    from vision_robot.track.admission import Admission

    image = Admission().converted(first)
    height, width = image.shape[:2]
    scale = min(1.0, PICTURE_PX / width)
    size = (round(width * scale), round(height * scale))
    grey = cv2.cvtColor(cv2.resize(image, size, interpolation=cv2.INTER_AREA), cv2.COLOR_BGR2GRAY)

    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        # Pale, so that the paths stand out.
        axes.imshow(
            128 + grey // 2, cmap="gray", vmin=0, vmax=255, extent=(-0.5, width - 0.5, height - 0.5, -0.5)
        )
        for path, colour in zip(paths, view_colours(len(paths)), strict=True):
            table = path.table
            axes.plot(table["u_px"], table["v_px"], color=colour)
            axes.text(
                table["u_px"][-1], table["v_px"][-1], str(path.id), color=colour, bbox=PLATE, fontsize=7
            )
        axes.set_xlim(-0.5, width - 0.5)
        axes.set_ylim(height - 0.5, -0.5)
        axes.set_xlabel("u [px]")
        axes.set_ylabel("v [px]")

    high = 0.48 + min(0.87 * WIDTH_IN * height / width, 1.4 * WIDTH_IN)
    caption = f"{len(paths)} paths over the first frame."
    return Figure(draw(paint, height_in=high), "Paths of the objects over the first frame", caption)


def path_figure(paths: Sequence[Path]) -> Figure:
    """Paths on the work plane, to scale."""

    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        axes.set_aspect("equal", adjustable="datalim")
        for path, colour in zip(paths, view_colours(len(paths)), strict=True):
            axes.plot(path.table["x_mm"], path.table["y_mm"], color=colour, label=str(path.id))
        axes.set_xlabel("x [mm]")
        axes.set_ylabel("y [mm]")
        _named(axes, paths)

    caption = "Paths on the work plane, in the station's frame {S}."
    return Figure(draw(paint, height_in=0.75 * WIDTH_IN), "Paths on the work plane in millimetres", caption)


def place_plots(paths: Sequence[Path], *, metric: bool) -> tuple[Figure, Figure]:
    """Both coordinates over time."""
    names, unit = (("x_mm", "y_mm"), "mm") if metric else (("u_px", "v_px"), "px")
    return tuple(
        _over_time(
            paths,
            lambda table, name=name: table[name],
            f"{name[0]} [{unit}]",
            f"{name[0]} of each object over time.",
        )
        for name in names
    )  # type: ignore[return-value]


def speed_plot(paths: Sequence[Path], *, metric: bool) -> Figure:
    """Speed over time."""
    names, unit = (("vx_mm_s", "vy_mm_s"), "mm/s") if metric else (("vu_px_s", "vv_px_s"), "px/s")
    return _over_time(
        paths,
        lambda table: np.hypot(table[names[0]], table[names[1]]),
        f"speed [{unit}]",
        "Speed of each object, from the filter's velocity.",
    )


def area_plot(paths: Sequence[Path]) -> Figure:
    """Area over time: steps are occlusions and merging."""
    return _over_time(
        paths,
        lambda table: table["area_px"],
        "area [px]",
        "Area of each object. A sudden step is an occlusion, or two objects that touch.",
    )


def _over_time(paths: Sequence[Path], of, label: str, caption: str) -> Figure:
    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        for path, colour in zip(paths, view_colours(len(paths)), strict=True):
            time, values = path.table["time_s"], of(path.table)
            if len(time) == 1:
                axes.plot(time, values, ".", color=colour, label=str(path.id))
            else:
                axes.plot(*_broken(time, values), color=colour, label=str(path.id))
        axes.set_xlabel("time [s]")
        axes.set_ylabel(label)
        _named(axes, paths)

    return Figure(draw(paint, height_in=0.55 * WIDTH_IN), f"{label} over time", caption)


def _broken(time: Float[Array, "k"], values: Float[Array, "k"]) -> tuple[Array, Array]:
    """The line left out where the object was out of sight."""
    step = np.diff(time)
    gap = np.flatnonzero(step > 3 * np.median(step)) + 1
    return np.insert(time, gap, np.nan), np.insert(values, gap, np.nan)


def _named(axes, paths: Sequence[Path]) -> None:
    if len(paths) <= MOST_NAMED:
        axes.legend(loc="best", handlelength=1.2, ncols=2 if len(paths) > 6 else 1)
