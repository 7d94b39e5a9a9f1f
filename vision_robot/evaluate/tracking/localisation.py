"""How exactly matched objects are placed and turned."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from vision_robot.evaluate.tracking.encounters import Encounters
from vision_robot.types import Array, Float, Int

__all__ = ["LocalisationScores", "localisation_scores", "matches", "yaw_difference"]


@dataclass(frozen=True)
class LocalisationScores:
    """Medians over matched rows, best 0; NaN where nothing was matched or the columns are empty.

    `recall` in [0, 1] is the share of the truth's rows matched at all: an error alone can be made
    small by answering only when it is easy.
    """

    centroid_error_px: float
    centroid_error_m: float
    yaw_error_rad: float
    speed_error_m_s: float
    recall: float


def localisation_scores(seen: Encounters, *, gate_px: float = 20.0) -> LocalisationScores:
    """Errors of the answers nearest to the truths, paired one to one within `gate_px`."""
    here, there = matches(seen, gate_px)
    truth, answer = seen.truth, seen.answer
    return LocalisationScores(
        centroid_error_px=_median_length(answer.centroid_px[there] - truth.centroid_px[here]),
        centroid_error_m=_median_length(answer.position_m[there] - truth.position_m[here]),
        yaw_error_rad=_median(yaw_difference(answer.yaw_rad[there], truth.yaw_rad[here])),
        speed_error_m_s=_median_length(answer.velocity_m_s[there] - truth.velocity_m_s[here]),
        recall=len(here) / len(truth) if len(truth) else np.nan,
    )


def matches(seen: Encounters, gate_px: float) -> tuple[Int[Array, "k"], Int[Array, "k"]]:
    """Rows of truth and answer paired by centroids: as many as lie within the gate, the nearest of all."""
    rows: list[Array] = []
    others: list[Array] = []
    for here, there in zip(seen.truth_rows, seen.answer_rows, strict=True):
        apart = np.linalg.norm(
            seen.truth.centroid_px[here][:, None] - seen.answer.centroid_px[there][None], axis=-1
        )
        # Past the gate a pair costs more than all pairs inside it together.
        cost = np.where(apart <= gate_px, apart, gate_px * (1 + min(apart.shape)))
        a, b = linear_sum_assignment(np.nan_to_num(cost, nan=gate_px * (1 + min(apart.shape))))
        inside = apart[a, b] <= gate_px
        rows.append(here[a[inside]])
        others.append(there[b[inside]])
    none = [np.zeros(0, dtype=np.int64)]
    return np.concatenate(rows or none), np.concatenate(others or none)


def yaw_difference(yaw: Float[Array, "n"], other: Float[Array, "n"]) -> Float[Array, "n"]:
    """Angle between two axes without a head, in [0, pi/2]."""
    return np.abs((yaw - other + np.pi / 2) % np.pi - np.pi / 2)


def _median_length(offset: Array) -> float:
    return _median(np.linalg.norm(offset, axis=1))


def _median(values: Array) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else np.nan
