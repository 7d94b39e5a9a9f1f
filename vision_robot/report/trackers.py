"""Several trackers on one video with known truth, side by side."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vision_robot.pick.film_drawing import cross
from vision_robot.report.figure import draw, view_colours
from vision_robot.report.page import Figure, Figures, Gallery, Paragraph, Part, Picture, Table
from vision_robot.report.photograph import photograph
from vision_robot.report.quantity import compact
from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float, Image

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

__all__ = ["Answer", "marked", "trackers_piece"]

COLUMNS = (
    ("centroid_error_px", "centroid [px]"),
    ("centroid_error_mm", "centroid [mm]"),
    ("yaw_error_deg", "yaw [°]"),
    ("recall", "recall"),
    ("ms_per_frame", "ms a frame"),
)


@dataclass(frozen=True)
class Answer:
    """What a tracker said of a video, and how good that was."""

    tracks: Tracks
    figures: Mapping[str, float]
    """By the names of `COLUMNS`."""


def trackers_piece(
    answers: Mapping[str, Answer], truth: Tracks, pictures: tuple[Image, ...]
) -> tuple[Part, ...]:
    """What a longer story tells of trackers: frames, figures, and errors over time.

    Args:
        answers: Tracker -> what it said.
        truth: Where the objects really were.
        pictures: A few frames with marks drawn in.
    """
    rows = tuple(
        (name, *(compact(answer.figures.get(column, np.nan)) for column, _ in COLUMNS))
        for name, answer in answers.items()
    )
    shown = tuple(
        Picture(photograph(image, 320), f"A frame of the video, {k + 1}", f"frame {k + 1} of {len(pictures)}")
        for k, image in enumerate(pictures)
    )
    columns = ("tracker", *(title for _, title in COLUMNS))
    caption = (
        "Against the truth: medians over frames; recall is the share of frames with an answer within 20 px."
    )
    return (
        Gallery(shown),
        Table(columns, rows, caption, frozenset(range(1, len(columns)))),
        Figures((_errors_over_time(answers, truth),)),
        Paragraph("Optical flow sees only what moves, background subtraction only what it has not learned."),
    )


def marked(image: Image, frame: int, answers: Mapping[str, Answer]) -> Image:
    """A frame with a cross where each tracker sees something, in the colours of the drawing of errors."""
    drawn = image.copy()
    for answer, colour in zip(answers.values(), view_colours(len(answers)), strict=True):
        red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
        for pixel in answer.tracks.centroid_px[answer.tracks.frame == frame]:
            cross(drawn, pixel, (blue, green, red))
    return drawn


def _errors_over_time(answers: Mapping[str, Answer], truth: Tracks) -> Figure:
    curves = {name: _nearest(answer.tracks, truth) for name, answer in answers.items()}

    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        for (name, (times, errors)), colour in zip(curves.items(), view_colours(len(curves)), strict=True):
            axes.plot(times, np.maximum(errors, 1e-2), color=colour, label=name)
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.set_xlabel("time [s]")
        axes.set_ylabel("distance to the truth [px]")
        axes.legend(loc="upper right", ncols=len(curves))

    return Figure(
        draw(paint, height_in=2.4),
        alt="Distance of each tracker's nearest answer to the truth over time",
        caption="Distance of the nearest answer to where the object is seen, frame by frame; gaps are frames "
        "without an answer.",
    )


def _nearest(answer: Tracks, truth: Tracks) -> tuple[Float[Array, "frames"], Float[Array, "frames"]]:
    times, errors = [], []
    for frame in np.unique(truth.frame):
        there, said = truth.centroid_px[truth.frame == frame], answer.centroid_px[answer.frame == frame]
        off = np.linalg.norm(said[:, None] - there[None], axis=2)
        times.append(float(truth.time_s[truth.frame == frame][0]))
        errors.append(float(np.nanmin(off)) if np.isfinite(off).any() else np.nan)
    return np.array(times), np.array(errors)
