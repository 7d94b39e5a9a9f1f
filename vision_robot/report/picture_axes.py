"""Axes that are a camera's picture: u to the right, v down, its outline drawn."""

from typing import TYPE_CHECKING

import numpy as np

from vision_robot.geometry import Camera
from vision_robot.report.figure import INK, WIDTH_IN
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas

__all__ = ["PLATE", "contour_map", "picture_axes", "picture_height_in"]

STEPS = (1, 2, 5)
"""Contours at 1, 2, 5, 10, 20, ...: each reads as a plain number."""

LABEL_ROOM = 0.09
"""Distance between labels, as a share of the picture's width."""

PLATE = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.8}
"""What a label on a drawing stands on."""


def picture_height_in(camera: Camera) -> float:
    """Height of a drawing that holds the picture at full width, in inches."""
    return 0.48 + min(max(0.873 * WIDTH_IN * camera.height / camera.width, 1.2), 1.4 * WIDTH_IN)


def picture_axes(canvas: "Canvas", camera: Camera, *, room_above: float = 0.0) -> "Axes":
    """Axes in pixels; `room_above` is left over the picture, as a share of its width."""
    from matplotlib.patches import Rectangle

    axes = canvas.add_subplot()
    axes.set_aspect("equal")
    edge = 0.012 * camera.width
    axes.set_xlim(-edge, camera.width + edge)
    axes.set_ylim(camera.height + edge, -edge - room_above * camera.width)
    axes.add_patch(
        Rectangle((-0.5, -0.5), camera.width, camera.height, fill=False, edgecolor=INK, linewidth=0.8)
    )
    axes.set_xlabel("u [px]")
    axes.set_ylabel("v [px]")
    axes.spines[["left", "bottom"]].set_visible(False)
    axes.tick_params(length=2.5)
    axes.xaxis.set_major_locator(_ticks())
    axes.yaxis.set_major_locator(_ticks())
    return axes


def contour_map(
    canvas: "Canvas", camera: Camera, grid: Float[Array, "h w 2"], size: Float[Array, "h w"]
) -> None:
    """Lengths in px over the picture: filled between contours that carry their value."""
    from matplotlib.colors import LinearSegmentedColormap

    axes = picture_axes(canvas, camera)
    known = size[np.isfinite(size)]
    if not known.size or known.max() <= 0:
        axes.text(camera.width / 2, camera.height / 2, "0 px everywhere", ha="center", va="center")
        return
    levels = _levels(known)
    u, v = grid[0, :, 0], grid[:, 0, 1]
    values = np.ma.masked_invalid(np.clip(size, levels[0], levels[-1]))
    blues = LinearSegmentedColormap.from_list(
        "blues", ["#f6f9fc", "#d3e3f0", "#a4c7e2", "#6fa6d0", "#3f7fb5"]
    )
    axes.contourf(u, v, values, levels=levels, colors=blues(np.linspace(0, 1, len(levels) - 1)), zorder=0)
    inner = levels[1:-1]
    lines = axes.contour(u, v, values, levels=inner, colors=INK, linewidths=0.6)
    for level, place in zip(inner, _label_places(lines.allsegs, camera), strict=True):
        if place is not None:
            axes.text(
                place[0], place[1], f"{level:g}", fontsize=7.5, ha="center", va="center_baseline", bbox=PLATE
            )


def _levels(known: Float[Array, "n"]) -> list[float]:
    """Contour values around all sizes: the 1-2-5 series, or even steps over a narrow range."""
    from matplotlib.ticker import MaxNLocator

    # Zeros of a difference would ask for ever smaller contours about themselves.
    low, high = float(np.quantile(known, 0.08)), float(known.max())
    low = max(low, 1e-3 * high)
    powers = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    series = [float(f"{step}e{power}") for power in powers for step in STEPS]
    inside = [level for level in series if low < level < high]
    if len(inside) < 3:
        even = MaxNLocator(nbins=6, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
        inside = [float(level) for level in even if low < level < high] or [(low + high) / 2]
    return [min(0.0, float(known.min())), *inside, max(high, inside[-1] * (1 + 1e-9))]


def _label_places(
    segments: list[list[Float[Array, "n 2"]]], camera: Camera
) -> list[Float[Array, "2"] | None]:
    """For each contour the point of it farthest from the labels before; none where it is crowded."""
    size = np.array([camera.width, camera.height])
    margin = np.array([0.035 * camera.width, 0.022 * camera.width])
    placed: list[Array] = []
    places: list[Array | None] = []
    for paths in segments:
        points = np.concatenate(paths) if paths else np.zeros((0, 2))
        points = points[np.all((points > margin) & (points < size - margin), axis=1)]
        if not len(points):
            places.append(None)
            continue
        room = (
            np.min([np.linalg.norm(points - other, axis=1) for other in placed], axis=0) if placed else None
        )
        best = int(np.argmax(points[:, 1])) if room is None else int(np.argmax(room))
        if room is not None and room[best] < LABEL_ROOM * camera.width:
            places.append(None)
            continue
        placed.append(points[best])
        places.append(points[best])
    return places


def _ticks():
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(nbins=7, integer=True, steps=[1, 2, 4, 5, 10])
