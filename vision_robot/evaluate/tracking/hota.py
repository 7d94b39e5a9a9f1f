"""HOTA: detection and association in one number (Luiten et al. 2021, IJCV 129, 548-578)."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from vision_robot.evaluate.tracking.encounters import EPSILON, Encounters
from vision_robot.types import Array, Float

__all__ = ["ALPHAS", "HotaScores", "hota_scores"]

ALPHAS = np.arange(0.05, 0.99, 0.05)
"""Similarities from which a pair counts; the paper's nineteen."""


@dataclass(frozen=True)
class HotaScores:
    """Each score for every alpha of `ALPHAS`, in [0, 1], best 1; the figure quoted is their mean."""

    detection: Float[Array, "19"]
    association: Float[Array, "19"]
    localisation: Float[Array, "19"]

    @property
    def hota(self) -> float:
        """Mean over alpha of ``sqrt(DetA AssA)`` (eq. 15 and 17)."""
        return float(np.sqrt(self.detection * self.association).mean())

    @property
    def deta(self) -> float:
        """Mean detection accuracy, ``TP / (TP + FN + FP)``."""
        return float(self.detection.mean())

    @property
    def assa(self) -> float:
        """Mean association accuracy: over the hits, how much of both tracks the pair shares."""
        return float(self.association.mean())

    @property
    def loca(self) -> float:
        """Mean similarity of the hits."""
        return float(self.localisation.mean())


def hota_scores(seen: Encounters) -> HotaScores:
    """Match each frame by similarity times the tracks' overall agreement, then count at every alpha."""
    n, m = seen.truth_objects, seen.answer_objects
    agreement, truths, answers = np.zeros((n, m)), np.zeros(n), np.zeros(m)
    for here, there, alike in zip(seen.truth_ids, seen.answer_ids, seen.similarity, strict=True):
        union = alike.sum(axis=0) + alike.sum(axis=1)[:, None] - alike
        share = np.divide(alike, union, out=np.zeros_like(alike), where=union > EPSILON)
        agreement[np.ix_(here, there)] += share
        truths[here] += 1
        answers[there] += 1
    rows = truths[:, None] + answers
    alignment = agreement / (rows - agreement)

    together = np.zeros((len(ALPHAS), n, m))
    hits, likeness = np.zeros(len(ALPHAS)), np.zeros(len(ALPHAS))
    for here, there, alike in zip(seen.truth_ids, seen.answer_ids, seen.similarity, strict=True):
        a, b = linear_sum_assignment(-alignment[np.ix_(here, there)] * alike)
        counts = alike[a, b] >= ALPHAS[:, None] - EPSILON
        hits += counts.sum(axis=1)
        likeness += counts @ alike[a, b]
        together[:, here[a], there[b]] += counts
    association = (together * together / np.maximum(1, rows - together)).sum(axis=(1, 2))
    return HotaScores(
        detection=hits / np.maximum(1, truths.sum() + answers.sum() - hits),
        association=association / np.maximum(1, hits),
        localisation=np.maximum(1e-10, likeness) / np.maximum(1e-10, hits),
    )
