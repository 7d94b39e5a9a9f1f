"""Identity scores: the one best pairing of whole tracks (Ristani et al. 2016)."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from vision_robot.evaluate.tracking.encounters import EPSILON, Encounters

__all__ = ["IdentityScores", "identity_scores"]


@dataclass(frozen=True)
class IdentityScores:
    """Rows explained by the pairing, and rows of truth and answer left over."""

    explained: int
    missed: int
    false: int

    @property
    def idf1(self) -> float:
        """``2 explained / (truths + answers)``, in [0, 1], best 1; NaN without either."""
        rows = 2 * self.explained + self.missed + self.false
        return 2 * self.explained / rows if rows else np.nan

    @property
    def precision(self) -> float:
        """``explained / answers``, in [0, 1]; NaN without an answer."""
        return self.explained / (self.explained + self.false) if self.explained + self.false else np.nan

    @property
    def recall(self) -> float:
        """``explained / truths``, in [0, 1]; NaN without truth."""
        return self.explained / (self.explained + self.missed) if self.explained + self.missed else np.nan


def identity_scores(seen: Encounters, *, threshold: float = 0.5) -> IdentityScores:
    """Pair whole tracks, one to one or to none, so that as few rows as possible stay unexplained."""
    n, m = seen.truth_objects, seen.answer_objects
    together, truths, answers = np.zeros((n, m)), np.zeros(n), np.zeros(m)
    for here, there, alike in zip(seen.truth_ids, seen.answer_ids, seen.similarity, strict=True):
        a, b = np.nonzero(alike >= threshold - EPSILON)
        together[here[a], there[b]] += 1
        truths[here] += 1
        answers[there] += 1
    # Leaving two tracks unpaired costs all their rows; pairing them saves two for each row together.
    rows, columns = linear_sum_assignment(-together)
    explained = int(together[rows, columns].sum())
    return IdentityScores(explained, int(truths.sum()) - explained, int(answers.sum()) - explained)
