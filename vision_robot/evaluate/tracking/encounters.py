"""Truth and answer side by side, frame by frame: what every tracking metric starts from."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadTable
from vision_robot.evaluate.tracking.overlap import box_overlap
from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float, Int

__all__ = ["Encounters", "encounters"]

Similarity = Callable[[Tracks, Tracks], Float[Array, "n m"]]

EPSILON = float(np.finfo(float).eps)
"""A similarity at the threshold counts as reaching it, whatever rounding did."""


@dataclass(frozen=True)
class Encounters:
    """For each frame the rows of truth and answer in it, and how alike they are.

    `truth_rows` and `answer_rows` index the tables; `truth_ids` and `answer_ids` number the objects
    from zero without gaps; `similarity` is in [0, 1], one array (truths, answers) a frame.
    """

    truth: Tracks
    answer: Tracks
    frames: Int[Array, "f"]
    truth_rows: list[Int[Array, "n"]]
    answer_rows: list[Int[Array, "m"]]
    truth_ids: list[Int[Array, "n"]]
    answer_ids: list[Int[Array, "m"]]
    similarity: list[Float[Array, "n m"]]

    @property
    def truth_objects(self) -> int:
        """How many different objects there are."""
        return len(self.truth.ids)

    @property
    def answer_objects(self) -> int:
        """How many different objects the answer names."""
        return len(self.answer.ids)


def by_boxes(truth: Tracks, answer: Tracks) -> Float[Array, "n m"]:
    """Overlap of boxes."""
    return box_overlap(truth.box_px, answer.box_px)


def encounters(truth: Tracks, answer: Tracks, similarity: Similarity = by_boxes) -> Encounters:
    """Bring truth and answer together, every frame that either has.

    Raises BadTable where an id stands twice in one frame, or where `similarity` gives no number:
    a metric on such a table would be nonsense with the look of a result.
    """
    for name, table in (("truth", truth), ("answer", answer)):
        _check_once(name, table)
    frames = np.union1d(truth.frame, answer.frame)
    truth_rows, answer_rows = _rows_by_frame(truth, frames), _rows_by_frame(answer, frames)
    truth_ids, answer_ids = (np.searchsorted(table.ids, table.id) for table in (truth, answer))
    alike = [
        similarity(truth.rows(a), answer.rows(b)) if len(a) and len(b) else np.zeros((len(a), len(b)))
        for a, b in zip(truth_rows, answer_rows, strict=True)
    ]
    for frame, values in zip(frames, alike, strict=True):
        if not np.isfinite(values).all():
            raise BadTable("tracks", f"frame {frame} has rows without the columns that are compared")
    return Encounters(
        truth,
        answer,
        frames,
        truth_rows,
        answer_rows,
        truth_ids=[truth_ids[rows] for rows in truth_rows],
        answer_ids=[answer_ids[rows] for rows in answer_rows],
        similarity=alike,
    )


def _rows_by_frame(table: Tracks, frames: Int[Array, "f"]) -> list[Int[Array, "n"]]:
    order = np.argsort(table.frame, kind="stable")
    bounds = np.searchsorted(table.frame[order], frames, side="left")
    ends = np.searchsorted(table.frame[order], frames, side="right")
    return [order[start:end] for start, end in zip(bounds, ends, strict=True)]


def _check_once(name: str, table: Tracks) -> None:
    pairs, counts = np.unique(np.stack([table.frame, table.id], axis=1), axis=0, return_counts=True)
    if (counts > 1).any():
        frame, label = pairs[counts > 1][0]
        raise BadTable(name, f"id {label} stands more than once in frame {frame}")
