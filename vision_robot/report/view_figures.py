"""Drawings of the views: where in the picture the boards were, and where before the camera."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from vision_robot.calibrate.judgement.corner_positions import corners_in_cam
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.geometry import Camera
from vision_robot.report.calibration_findings import Findings
from vision_robot.report.figure import INK, WIDTH_IN, draw, segments, view_colours
from vision_robot.report.page import Figure
from vision_robot.report.picture_axes import picture_axes, picture_height_in
from vision_robot.report.quantity import compact
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas
    from mpl_toolkits.mplot3d import Axes3D

__all__ = ["board_poses", "coverage"]

MOST_MARKS = 4000
MOST_BOARDS = 100
NUMBER_ROOM = 0.07
"""Distance between numbers of boards, as a share of the drawing's width."""


def coverage(findings: Findings) -> Figure:
    """All corners over the picture, a colour for each view."""
    import cv2

    result = findings.result
    colours = view_colours(len(result.corners))
    skip = max(1, -(-len(colours) // MOST_BOARDS))
    every = max(1, -(-result.corner_count // (skip * MOST_MARKS)))

    def paint(canvas: "Canvas") -> None:
        from matplotlib.patches import Polygon

        axes = picture_axes(canvas, result.camera)
        opacity = min(0.08, skip / len(colours))
        for view, colour in zip(result.corners[::skip], colours[::skip], strict=True):
            hull = cv2.convexHull(view.pixels.astype(np.float32))[:, 0]
            axes.add_patch(Polygon(hull, facecolor=colour, edgecolor="none", alpha=opacity))
            segments(axes, view.pixels[::every], colour=colour, width=1.7)

    thinned = f" One view in {skip} is drawn." if skip > 1 else ""
    thinned += f" One corner in {every} is drawn." if every > 1 else ""
    return Figure(
        draw(paint, height_in=picture_height_in(result.camera)),
        alt="Corners of all views over the outline of the picture",
        caption=f"The {result.corner_count} corners in the picture, a colour for each view. "
        f"{compact(100 * findings.covered, 2)} % of the picture lies inside at least one board.{thinned}",
    )


def board_poses(findings: Findings, outline: Float[Array, "k 3"] | None = None) -> Figure:
    """Boards before the camera; `outline` is the board's edge in its own frame [m]."""
    result = findings.result
    every = max(1, -(-len(result.corners) // MOST_BOARDS))
    shown = range(0, len(result.corners), every)
    colours = view_colours(len(result.corners))
    boards = {view: 1000 * board for view, board in _outlines(result, shown, outline).items()}
    depth = 300 * findings.board_distance
    frustum = _frustum(result.camera, depth)

    def paint(canvas: "Canvas") -> None:
        from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

        axes: Axes3D = canvas.add_axes((-0.06, -0.03, 1.03, 1.1), projection="3d")  # pyright: ignore[reportAssignmentType]
        axes.set_proj_type("persp", focal_length=0.6)
        faces = [_upright(board) for board in boards.values()]
        edges = [colours[view] for view in boards]
        axes.add_collection3d(
            Poly3DCollection(
                faces, facecolors=[f"{colour}0c" for colour in edges], edgecolors=edges, linewidths=0.9
            )
        )
        axes.add_collection3d(Line3DCollection(_upright(frustum), colors=INK, linewidths=0.9))
        _frame(axes, np.concatenate([*faces, _upright(frustum.reshape(-1, 3))]))
        for view in _with_room(axes, boards):
            x, y, z = _upright(boards[view][0])
            axes.text(x, y, z, f"{view + 1}", color=colours[view], fontsize=7)

    thinned = f" One view in {every} is drawn." if every > 1 else ""
    tilt = np.degrees(findings.tilt)
    return Figure(
        draw(paint, height_in=0.86 * WIDTH_IN),
        alt="Boards in space before the camera's pyramid of view",
        caption=f"The boards as seen from behind and above the camera, whose pyramid of view is black. "
        f"Distances {compact(1000 * float(np.nanmin(findings.distance)))} to "
        f"{compact(1000 * float(np.nanmax(findings.distance)))} mm; boards tilted {tilt.min():.0f}° to "
        f"{tilt.max():.0f}° against the picture plane. Numbers are views, written at a board's first corner "
        f"where there is room.{thinned}",
    )


def _outlines(
    result: CalibrationResult, views: Iterable[int], outline: Float[Array, "k 3"] | None
) -> dict[int, Float[Array, "k 3"]]:
    """Edges of boards in the camera frame [m]; of the corners seen where no outline is given."""
    if outline is not None:
        return {view: result.cam_from_board[view].apply(outline) for view in views}
    import cv2

    edges, corners = {}, corners_in_cam(result)
    for view in views:
        points = corners[view][np.isfinite(corners[view]).all(axis=1)]
        in_board = result.cam_from_board[view].inverse().apply(points)
        hull = cv2.convexHull(in_board[:, :2].astype(np.float32), returnPoints=False)
        edges[view] = points[np.asarray(hull, dtype=np.int64).ravel()]
    return edges


def _with_room(axes: "Axes3D", boards: dict[int, Float[Array, "k 3"]]) -> list[int]:
    """Views whose number does not run into another's."""
    from mpl_toolkits.mplot3d import proj3d

    projection, width = axes.get_proj(), 0.18
    placed: dict[int, Array] = {}
    for view, board in boards.items():
        x, y, z = _upright(board[0])
        place = np.array(proj3d.proj_transform(x, y, z, projection)[:2])
        if all(np.linalg.norm(place - other) > NUMBER_ROOM * width for other in placed.values()):
            placed[view] = place
    return list(placed)


def _frustum(camera: Camera, depth: float) -> Float[Array, "8 2 3"]:
    """Edges of the pyramid from the camera's centre through the corners of its picture."""
    w, h = camera.width - 1, camera.height - 1
    rays = camera.unproject(np.array([[0.0, 0.0], [w, 0], [w, h], [0, h]]))
    if not np.isfinite(rays).all() or rays[:, 2].min() < 0.2:
        # A very wide picture has no pyramid; show its middle.
        x, y = 0.5 * camera.width / camera.fx, 0.5 * camera.height / camera.fy
        rays = np.array([[-x, -y, 1.0], [x, -y, 1], [x, y, 1], [-x, y, 1]])
    tips = depth * rays / rays[:, 2:]
    sides = np.stack([np.zeros_like(tips), tips], axis=1)
    return np.concatenate([sides, np.stack([tips, np.roll(tips, -1, axis=0)], axis=1)])


def _upright(points: Array) -> Array:
    """Camera axes (x right, y down, z forward) laid out as the drawing's (x, z, y)."""
    return points[..., [0, 2, 1]]


def _frame(axes: Any, points: Array) -> None:
    from matplotlib.ticker import MaxNLocator

    low, high = points.min(axis=0), points.max(axis=0)
    low, high = low - 0.04 * (high - low), high + 0.04 * (high - low)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_zlim(high[2], low[2])
    axes.set_box_aspect(high - low, zoom=0.98)
    axes.view_init(elev=20, azim=-58)
    for axis, name in ((axes.xaxis, "x right"), (axes.yaxis, "z forward"), (axes.zaxis, "y down")):
        axis.set_label_text(f"{name} [mm]")
        axis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 5, 10]))
        axis.pane.set_facecolor("#f7f9fa")
        axis.pane.set_edgecolor("#d5dae0")
        axis._axinfo["grid"].update(color="#e3e7eb", linewidth=0.5)
    axes.tick_params(labelsize=7, pad=0)
