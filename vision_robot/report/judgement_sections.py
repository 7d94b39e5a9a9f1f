"""The part of a calibration's page that says how far to believe it, and what to photograph next."""

from typing import TYPE_CHECKING

import numpy as np

from vision_robot.calibrate.judgement import Judgement
from vision_robot.calibrate.judgement.error_budget import ErrorBudget
from vision_robot.calibrate.judgement.next_view import NextViews
from vision_robot.calibrate.judgement.selection import Selection
from vision_robot.geometry import Camera
from vision_robot.report.figure import draw, view_colours
from vision_robot.report.page import Figure, Figures, Paragraph, Part, Remarks, Section, Table
from vision_robot.report.picture_axes import PLATE, picture_axes, picture_height_in
from vision_robot.report.quantity import compact

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

__all__ = ["judgement_sections", "selection_section"]


def judgement_sections(judgement: Judgement, camera: Camera) -> tuple[Section, ...]:
    """Trust, error budget and next views, as far as the views carry them."""
    sections = [Section("Can it be believed", _trust(judgement))]
    if judgement.error_budget:
        sections.append(Section("Where the error comes from", _budget(judgement.error_budget)))
    if judgement.next_views and len(judgement.next_views):
        sections.append(Section("What to photograph next", _next(judgement.next_views, camera)))
    return tuple(sections)


def _trust(judgement: Judgement) -> tuple[Part, ...]:
    remarks: list[tuple[str, str]] = []
    if judgement.held_out:
        text = (
            f"Views held out, each once, err by {compact(judgement.held_out.rms_px)} px rms per point "
            f"(standard error {compact(judgement.held_out.standard_error_px, 2)} px)."
        )
        remarks.append(("note", text))
    for asked in (judgement.halves, judgement.bootstrap):
        if asked:
            remarks.append(("good" if asked.honest else "caution", _sentence(asked.sentence)))
    if judgement.influence:
        fine = not (judgement.influence.decisive or judgement.influence.contradicting)
        remarks += [("good" if fine else "note", _sentence(said)) for said in judgement.influence.sentences]
    open_questions = [f"Not answered: {name}: {why}." for name, why in judgement.unanswered.items()]
    return (Remarks(tuple(remarks)), *map(Paragraph, open_questions))


def _budget(budget: ErrorBudget) -> tuple[Part, ...]:
    rows = [
        (line.cause, compact(line.px), compact(line.mm), compact(line.at_most_px), line.note)
        for line in budget.lines
    ]
    rows.append(("all together", compact(budget.total_px), compact(budget.total_mm), "", "added in squares"))
    caption = (
        "Error of the projection, root mean square over the picture after the rotation that suits best; "
        f"mm on a plane facing the camera at {compact(1000 * budget.distance_m)} mm. “At most” is what "
        "could hide in the noise (95 %)."
    )
    return (Table(("cause", "px", "mm", "at most px", "why"), tuple(rows), caption, frozenset({1, 2, 3})),)


def _next(views: NextViews, camera: Camera) -> tuple[Part, ...]:
    rows = [
        (str(i + 1), _sentence(words), compact(alone), compact(together))
        for i, (words, alone, together) in enumerate(
            zip(views.words, views.alone_px, views.together_px, strict=True)
        )
    ]
    caption = (
        f"Views that lower the projection uncertainty most, now {compact(views.sigma_px)} px rms over the "
        "picture: with this view alone, and with it and all before it."
    )
    columns = ("view", "how to hold the board", "alone px", "together px")
    return (Figures((_drawn(views, camera),)), Table(columns, tuple(rows), caption, frozenset({2, 3})))


def _drawn(views: NextViews, camera: Camera) -> Figure:
    """The boards as they should appear in the picture."""
    import cv2

    hulls = [
        cv2.convexHull(pixels[seen].astype(np.float32))[:, 0]
        for pixels, seen in zip(views.views.pixels, views.views.seen, strict=True)
    ]

    def paint(canvas: "Canvas") -> None:
        from matplotlib.patches import Polygon

        axes = picture_axes(canvas, camera)
        for i, (hull, colour) in enumerate(zip(hulls, view_colours(len(hulls)), strict=True)):
            axes.add_patch(Polygon(hull, facecolor=f"{colour}18", edgecolor=colour, linewidth=1.2))
            u, v = hull.mean(axis=0)
            axes.text(u, v, str(i + 1), color=colour, ha="center", va="center", bbox=PLATE)

    return Figure(
        draw(paint, height_in=picture_height_in(camera)),
        alt="Outlines of the board in the picture, one for each proposed view",
        caption="Where the outermost corners of the board should appear in each proposed view.",
    )


def selection_section(selection: Selection) -> Section:
    """The candidates that were tried, and why one was chosen."""
    rows = tuple(
        (
            f"{one.model}, board {'as drawn' if one.warp == 0 else f'degree {one.warp}'}",
            str(selection.parameters[i]),
            compact(float(selection.rms_px[i])),
            compact(float(selection.held_out_px[i])),
            selection.why[i],
        )
        for i, one in enumerate(selection.settings)
    )
    caption = (
        "Lens models and board shapes, judged by the error on views they were not fitted to: the simplest "
        "that is as good as the best is taken."
    )
    columns = ("candidate", "numbers", "rms px", "held out px", "why")
    return Section("Choice of model", (Table(columns, rows, caption, frozenset({1, 2, 3})),))


def _sentence(text: str) -> str:
    first = text.split(" ", 1)[0]
    start = text[:1].upper() if first.isalpha() else text[:1]  # a file's name stays as it is
    return f"{start}{text[1:]}."
