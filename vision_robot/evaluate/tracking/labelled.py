"""What of an answer a dataset's truth judges: labelled frames, and not what labels tell to leave out."""

from collections.abc import Iterator

import numpy as np
from scipy.optimize import linear_sum_assignment

from vision_robot.dataset import Dataset
from vision_robot.evaluate.tracking.overlap import box_overlap
from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float

__all__ = ["judged", "labelled_frames", "without_ignored"]

SAME = 0.5
"""Overlap from which an answer may be of a label that does not count (MOTChallenge)."""


def labelled_frames(data: Dataset, start: int = 0) -> range:
    """From the first frame with truth, and from `start`, to the last; labels often end before the video."""
    frames = data.truth.frame
    return range(max(start, int(frames.min())), int(frames.max()) + 1) if len(frames) else range(0)


def judged(data: Dataset, answer: Tracks, start: int = 0) -> tuple[Tracks, Tracks]:
    """Truth and answer in the labelled frames from `start` on, without what is to be ignored."""
    frames = labelled_frames(data, start)
    truth, ignored, found = (
        table.rows(np.flatnonzero((table.frame >= frames.start) & (table.frame < frames.stop)))
        for table in (data.truth, data.ignored, answer)
    )
    return truth, without_ignored(truth, ignored, found)


def without_ignored(truth: Tracks, ignored: Tracks, answer: Tracks) -> Tracks:
    """The answer less rows that fit to an ignored label better than to any truth.

    As MOTChallenge does before it scores: in each frame labels of both kinds are matched to answers by
    overlap of half or more, and answers matched to ignored labels are neither right nor wrong.
    """
    if not len(ignored):
        return answer
    kept = np.ones(len(answer), dtype=bool)
    for frame in np.unique(ignored.frame):
        here, there, rows = (np.flatnonzero(one.frame == frame) for one in (truth, ignored, answer))
        labels = np.concatenate([truth.box_px[here], ignored.box_px[there]])
        for label, row in _matched(box_overlap(labels, answer.box_px[rows])):
            kept[rows[row]] &= label < len(here)
    return answer.rows(np.flatnonzero(kept))


def _matched(overlap: Float[Array, "n m"]) -> Iterator[tuple[int, int]]:
    alike = np.where(np.nan_to_num(overlap) >= SAME, overlap, 0.0)
    pairs = linear_sum_assignment(-alike)
    return ((int(a), int(b)) for a, b in zip(*pairs, strict=True) if alike[a, b] > 0)
