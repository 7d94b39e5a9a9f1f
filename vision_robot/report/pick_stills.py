"""Stills of an episode as pictures of a page."""

from collections.abc import Sequence

from vision_robot.pick.film import Still
from vision_robot.report.page import Gallery, Picture
from vision_robot.report.photograph import photograph

__all__ = ["film_strip"]


def film_strip(stills: Sequence[Still], name: str) -> Gallery:
    """A picture of each of the `stills`, and what was true at that moment."""
    return Gallery(
        tuple(
            Picture(
                data_uri=photograph(still.image),
                alt=f"{name}, {still.phase}",
                caption=f"{name}, {still.time_s:.1f} s: {'; '.join((still.phase, *still.said))}",
            )
            for still in stills
        ),
        wide=True,
    )
