"""The page of a tracked video."""

from pathlib import PurePath

import numpy as np

from vision_robot.report.page import (
    Facts,
    Figures,
    Footer,
    Page,
    Paragraph,
    Remarks,
    Section,
)
from vision_robot.report.quantity import compact
from vision_robot.report.track_figures import area_plot, path_figure, path_picture, place_plots, speed_plot
from vision_robot.report.track_table import track_table
from vision_robot.report.versions import versions
from vision_robot.track.history import History
from vision_robot.track.session import Session
from vision_robot.types import Image

__all__ = ["tracks_page"]

MOST_DRAWN = 24
"""Objects in the drawings; a table lists more."""


def tracks_page(session: Session, history: History, first: Image, source: str, *, command: str = "") -> Page:
    """What was tracked in a video: paths over its first frame, places, speeds and areas over time.

    Args:
        session: The session after its last frame.
        history: Its rows, thinned.
        first: The first frame.
        source: Name of the video.
        command: Command line that makes the page again.
    """
    paths = history.longest(MOST_DRAWN)
    metric = any(np.isfinite(path.table["x_mm"]).any() for path in paths)
    sections = [Section("Result", (_facts(session, history), Remarks(session.remarks())))]
    if paths:
        drawn = f" The {len(paths)} seen longest are drawn." if len(paths) < len(history.paths) else ""
        pictures = (path_picture(first, paths), *((path_figure(paths),) if metric else ()))
        sections.append(Section("Paths", (Figures(pictures), Paragraph(ABOUT_PATHS + drawn))))
        plots = (*place_plots(paths, metric=metric), speed_plot(paths, metric=metric), area_plot(paths))
        sections.append(Section("Over time", (Figures(plots),)))
        sections.append(Section("Objects", (track_table(history, metric=metric),)))
    seen = f"{session.objects} objects in {session.frames} frames of {PurePath(source).name}"
    summary = f"{seen}, by tracker {session.tracker.name}."
    return Page("Tracks", summary, tuple(sections), Footer(versions(), None, command))


ABOUT_PATHS = "Paths of the objects' centres, a colour for each; a number stands where one ends."


def _facts(session: Session, history: History) -> Facts:
    latency, moved = session.latency, session.camera.largest_px
    slow = f"{compact(latency.quantile_ms(0.99))} at the 99th percentile"
    return Facts(
        (
            ("objects", str(session.objects), "confirmed by repeated sightings"),
            ("frames", str(session.frames), f"{history.rows} rows"),
            ("ms a frame", compact(latency.quantile_ms(0.5)), slow),
            ("camera moved", f"{compact(moved, 2)} px", "largest shift of the whole picture"),
        )
    )
