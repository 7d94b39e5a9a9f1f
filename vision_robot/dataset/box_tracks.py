"""Tracks from tables that know boxes only."""

from collections.abc import Mapping

import numpy as np

from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float, Int

__all__ = ["tracks_of_boxes"]


def tracks_of_boxes(
    frame: Int[Array, "n"],
    id: Int[Array, "n"],  # noqa: A002
    box_px: Float[Array, "n 4"],
    times_s: Float[Array, "frames"],
    extra: Mapping[str, Float[Array, "n"]] | None = None,
) -> Tracks:
    """Rows sorted by frame, then id; the centroid is the middle of the box, all else unknown.

    A box is (left, top, width, height) in the house's pixels.
    """
    order = np.lexsort((id, frame))
    frame, id, box = frame[order], id[order], box_px[order]  # noqa: A001
    unknown, pairs = np.full(len(frame), np.nan), np.full((len(frame), 2), np.nan)
    columns = {name: column[order] for name, column in (extra or {}).items()}
    middle = box[:, :2] + box[:, 2:] / 2
    return Tracks(
        frame, times_s[frame], id, middle, box, unknown, pairs, unknown, pairs, pairs, extra=columns
    )
