"""CLEAR MOT: misses, false alarms and switches (Bernardin & Stiefelhagen 2008)."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from vision_robot.evaluate.tracking.encounters import EPSILON, Encounters

__all__ = ["ClearScores", "clear_scores"]

FAITHFUL = 1000.0
"""A pair of the frame before is kept whatever the similarity of another, as the paper's step 1 says."""


@dataclass(frozen=True)
class ClearScores:
    """Counts over all frames, and what is made of them."""

    hits: int
    misses: int
    false_alarms: int
    switches: int
    similarity_sum: float

    @property
    def mota(self) -> float:
        """``1 - (misses + false alarms + switches) / truths``, in (-inf, 1], best 1; NaN without truth."""
        truths = self.hits + self.misses
        return (self.hits - self.false_alarms - self.switches) / truths if truths else np.nan

    @property
    def motp(self) -> float:
        """Mean similarity of the hits, in [threshold, 1], best 1; NaN without a hit."""
        return self.similarity_sum / self.hits if self.hits else np.nan

    @property
    def recall(self) -> float:
        """``hits / truths``, in [0, 1], best 1; NaN without truth."""
        return self.hits / (self.hits + self.misses) if self.hits + self.misses else np.nan

    @property
    def precision(self) -> float:
        """``hits / answers``, in [0, 1], best 1; NaN without an answer."""
        return self.hits / (self.hits + self.false_alarms) if self.hits + self.false_alarms else np.nan


def clear_scores(seen: Encounters, *, threshold: float = 0.5) -> ClearScores:
    """Match frame by frame at `threshold`, the pairs of the frame before first, then by similarity.

    A switch is counted where an object is matched to another answer than when it was last matched,
    however long ago.
    """
    last = np.full(seen.truth_objects, -1)
    before = np.full(seen.truth_objects, -1)
    hits = misses = alarms = switches = 0
    total = 0.0
    for truths, answers, alike in zip(seen.truth_ids, seen.answer_ids, seen.similarity, strict=True):
        score = FAITHFUL * (before[truths][:, None] == answers) + alike
        score[alike < threshold - EPSILON] = 0
        rows, columns = linear_sum_assignment(-score)
        real = score[rows, columns] > 0
        rows, columns = rows[real], columns[real]
        matched, found = truths[rows], answers[columns]
        switches += int(((last[matched] >= 0) & (last[matched] != found)).sum())
        if len(truths) and len(answers):
            before[:] = -1
            before[matched] = found
        last[matched] = found
        hits += len(rows)
        misses += len(truths) - len(rows)
        alarms += len(answers) - len(rows)
        total += float(alike[rows, columns].sum())
    return ClearScores(hits, misses, alarms, switches, total)
