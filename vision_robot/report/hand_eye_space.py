"""The cell in space: base, wrist poses, cameras and boards."""

from typing import TYPE_CHECKING, Any

import numpy as np

from vision_robot.calibrate.hand_eye import HandEyeResult
from vision_robot.geometry import SE3, Camera
from vision_robot.report.figure import ACCENT, FAINT, INK, WARM, WIDTH_IN, draw
from vision_robot.report.page import Figure
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas
    from mpl_toolkits.mplot3d import Axes3D

__all__ = ["cell_in_space"]

MOST_VIEWS = 60
AXES = (("x", WARM), ("y", "#1c6b43"), ("z", ACCENT))


def cell_in_space(result: HandEyeResult, outline: Float[Array, "k 3"] | None = None) -> Figure:
    """All frames of the cell in the base; `outline` is the board's edge in its own frame [m]."""
    every = max(1, -(-len(result.names) // MOST_VIEWS))
    wrists = result.base_from_wrist[np.arange(0, len(result.names), every)]
    X, Z = result.mount_from_cam, result.far_from_board
    in_hand = result.setup.carries_camera
    cameras = wrists @ X if in_hand else SE3(X.rotation[None], X.translation[None])
    boards = SE3(Z.rotation[None], Z.translation[None]) if in_hand else wrists @ Z
    edge = 1000 * (outline if outline is not None else _hull(result))
    reach = 1000 * float(
        np.ptp(np.concatenate([wrists.translation, cameras.translation, np.zeros((1, 3))]), axis=0).max()
    )
    length = 0.12 * max(reach, 1.0)

    def paint(canvas: "Canvas") -> None:
        from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

        axes: Axes3D = canvas.add_axes((-0.04, -0.02, 1.02, 1.08), projection="3d")  # pyright: ignore[reportAssignmentType]
        axes.set_proj_type("persp", focal_length=0.6)
        faces = [_millimetres(boards[i]).apply(edge) for i in range(len(boards))]
        colour = INK if in_hand else FAINT
        axes.add_collection3d(
            Poly3DCollection(faces, facecolors="#1f5fa80f", edgecolors=colour, linewidths=0.8)
        )
        pyramids = [
            _pyramid(result.camera, _millimetres(cameras[i]), 0.7 * length) for i in range(len(cameras))
        ]
        lines = np.concatenate(pyramids)
        axes.add_collection3d(Line3DCollection(lines, colors=FAINT if in_hand else INK, linewidths=0.7))
        for k, (_, shade) in enumerate(AXES):
            axes.add_collection3d(
                Line3DCollection(_axis(wrists, k, 0.45 * length), colors=shade, linewidths=0.8)
            )
            base = np.array([[np.zeros(3), 1.4 * length * np.eye(3)[k]]])
            axes.add_collection3d(Line3DCollection(base, colors=shade, linewidths=2.0))
        axes.text(0, 0, -0.25 * length, "{B}", fontsize=8, ha="center")
        points = [*faces, lines.reshape(-1, 3), 1000 * wrists.translation, np.zeros((1, 3))]
        _frame(axes, np.concatenate(points))

    thinned = f" One view in {every} is drawn." if every > 1 else ""
    what = (
        "The wrist in every view, the camera it carries (grey) and the board (black outline)"
        if in_hand
        else "The wrist in every view, the board it carries (grey) and the camera that stands aside (black)"
    )
    return Figure(
        draw(paint, height_in=0.9 * WIDTH_IN),
        alt="Base, wrist poses, cameras and boards in space",
        caption=f"{what}, in the base frame {{B}} at the origin; x, y and z axes orange, green and "
        f"blue.{thinned}",
    )


def _hull(result: HandEyeResult) -> Float[Array, "k 3"]:
    """Outline of the board points seen [m]."""
    import cv2

    seen = result.problem.pictures.seen
    points = np.swapaxes(seen.points, 1, 2)[seen.present]
    hull = cv2.convexHull(points[:, :2].astype(np.float32))[:, 0]
    return np.concatenate([hull, np.zeros((len(hull), 1))], axis=1)


def _millimetres(pose: SE3) -> SE3:
    return SE3(pose.rotation, 1000 * pose.translation)


def _axis(poses: SE3, k: int, length: float) -> Float[Array, "n 2 3"]:
    start = 1000 * poses.translation
    return np.stack([start, start + length * poses.rotation[..., k]], axis=1)


def _pyramid(camera: Camera, pose: SE3, depth: float) -> Float[Array, "8 2 3"]:
    """Edges of a camera's pyramid of view."""
    x, y = 0.5 * camera.width / camera.fx, 0.5 * camera.height / camera.fy
    x, y = min(x, 1.0), min(y, 1.0)  # a very wide lens is drawn as a wide one
    tips = pose.apply(depth * np.array([[-x, -y, 1.0], [x, -y, 1], [x, y, 1], [-x, y, 1]]))
    sides = np.stack([np.broadcast_to(pose.translation, tips.shape), tips], axis=1)
    return np.concatenate([sides, np.stack([tips, np.roll(tips, -1, axis=0)], axis=1)])


def _frame(axes: Any, points: Float[Array, "n 3"]) -> None:
    from matplotlib.ticker import MaxNLocator

    low, high = points.min(axis=0), points.max(axis=0)
    room = np.maximum(high - low, 0.25 * (high - low).max())
    middle = (low + high) / 2
    low, high = middle - 0.53 * room, middle + 0.53 * room
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_zlim(low[2], high[2])
    axes.set_box_aspect(high - low, zoom=0.98)
    axes.view_init(elev=24, azim=-52)
    for axis, name in ((axes.xaxis, "x"), (axes.yaxis, "y"), (axes.zaxis, "z")):
        axis.set_label_text(f"{name} [mm]")
        axis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 5, 10]))
        axis.pane.set_facecolor("#f7f9fa")
        axis.pane.set_edgecolor("#d5dae0")
        axis._axinfo["grid"].update(color="#e3e7eb", linewidth=0.5)
    axes.tick_params(labelsize=7, pad=0)
