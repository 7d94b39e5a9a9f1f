"""Frames, cameras and boards in space."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vision_robot.geometry import SE3, Camera
from vision_robot.report.figure import ACCENT, FAINT, INK, WARM, WIDTH_IN, draw
from vision_robot.report.hand_eye_space import AXES, framed, pyramid
from vision_robot.report.page import Figure
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas
    from mpl_toolkits.mplot3d import Axes3D

__all__ = ["InSpace", "space_figure"]


@dataclass(frozen=True)
class InSpace:
    """What is drawn, all in one frame [m]: cameras, other frames by name, outlines, points and lines."""

    cameras: Sequence[tuple[str, Camera, SE3]] = ()
    """Name, camera, and frame_from_cam."""
    frames: Sequence[tuple[str, SE3]] = ()
    small_frames: SE3 | None = None
    outlines: Sequence[Float[Array, "k 3"]] = ()
    points: Float[Array, "n 3"] | None = None
    lines: Float[Array, "m 2 3"] | None = None


def space_figure(scene: InSpace, *, alt: str, caption: str) -> Figure:
    """The scene in millimetres; x, y and z axes of frames are orange, green and blue."""
    places = [pose.translation for _, _, pose in scene.cameras]
    places += [pose.translation for _, pose in scene.frames]
    everything = [np.array(places).reshape(-1, 3), *scene.outlines]
    everything += [part for part in (scene.points,) if part is not None]
    if scene.small_frames is not None:
        everything.append(scene.small_frames.translation)
    reach = float(np.ptp(1000 * np.concatenate(everything), axis=0).max())
    length = 0.13 * max(reach, 1.0)

    def paint(canvas: "Canvas") -> None:
        from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

        axes: Axes3D = canvas.add_axes((-0.04, -0.02, 1.02, 1.08), projection="3d")  # pyright: ignore[reportAssignmentType]
        axes.set_proj_type("persp", focal_length=0.6)
        shown = [1000 * part for part in everything]
        if scene.outlines:
            faces = [1000 * outline for outline in scene.outlines]
            axes.add_collection3d(
                Poly3DCollection(faces, facecolors="#1f5fa812", edgecolors=ACCENT, linewidths=0.8)
            )
        for name, camera, pose in scene.cameras:
            lines = pyramid(camera, SE3(pose.rotation, 1000 * pose.translation), 0.9 * length)
            axes.add_collection3d(Line3DCollection(list(lines), colors=INK, linewidths=0.8))
            x, y, z = 1000 * pose.translation
            axes.text(x, y, z, f" {name}", fontsize=7.5)
            shown.append(lines.reshape(-1, 3))
        for name, pose in scene.frames:
            _triad(axes, pose, length, 1.8)
            x, y, z = 1000 * pose.translation
            axes.text(x, y, z - 0.2 * length, name, fontsize=8, ha="center")
            shown.append(1000 * pose.translation[None] + length * pose.rotation.T)
        if scene.small_frames is not None:
            for i in range(len(scene.small_frames)):
                _triad(axes, scene.small_frames[i], 0.35 * length, 0.8)
        if scene.lines is not None:
            axes.add_collection3d(Line3DCollection(list(1000 * scene.lines), colors=FAINT, linewidths=0.7))
        if scene.points is not None:
            x, y, z = 1000 * scene.points.T
            axes.plot(x, y, z, linestyle="none", marker="o", markersize=2.2, color=WARM)
        framed(axes, np.concatenate(shown))

    return Figure(draw(paint, height_in=0.9 * WIDTH_IN), alt=alt, caption=caption)


def _triad(axes: "Axes3D", pose: SE3, length: float, width: float) -> None:
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    start = 1000 * pose.translation
    for k, (_, shade) in enumerate(AXES):
        line = np.array([[start, start + length * pose.rotation[:, k]]])
        axes.add_collection3d(Line3DCollection(list(line), colors=shade, linewidths=width))
