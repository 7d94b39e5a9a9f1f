"""What happens to a track while its object is hidden, and after."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadTable
from vision_robot.evaluate.tracking.encounters import Encounters
from vision_robot.evaluate.tracking.localisation import matches

__all__ = ["OcclusionScores", "occlusion_scores"]


@dataclass(frozen=True)
class OcclusionScores:
    """Recall while hidden, and what is needed to find objects again.

    `recall` in [0, 1], best 1, is the share of hidden rows still answered; `reacquisition_s`, best 0,
    the median time from an object's coming out to its first match; `kept_identity` in [0, 1], best 1,
    the share of those found again under the id they had before; NaN where nothing was hidden.
    """

    recall: float
    reacquisition_s: float
    kept_identity: float
    episodes: int


def occlusion_scores(seen: Encounters, *, hidden: float = 0.5, gate_px: float = 20.0) -> OcclusionScores:
    """Needs the truth's further column `occluded`: the hidden share of each object in each frame."""
    if "occluded" not in seen.truth.extra:
        raise BadTable("truth", "it has no column 'occluded'")
    truth, answer = seen.truth, seen.answer
    here, there = matches(seen, gate_px)
    matched = np.full(len(truth), -1)
    matched[here] = answer.id[there]
    covered = truth.extra["occluded"] >= hidden
    waits, kept, episodes = [], [], 0
    for one in truth.ids:
        rows = np.flatnonzero(truth.id == one)
        rows = rows[np.argsort(truth.frame[rows])]
        for out in np.flatnonzero(covered[rows][:-1] & ~covered[rows][1:]) + 1:
            episodes += 1
            hidden_again = np.flatnonzero(covered[rows[out:]])
            until = out + hidden_again[0] if len(hidden_again) else len(rows)
            found = np.flatnonzero(matched[rows[out:until]] >= 0)
            before = matched[rows[:out]][(matched[rows[:out]] >= 0) & ~covered[rows[:out]]]
            if not len(found):
                waits.append(np.inf)
                kept.append(False)
                continue
            waits.append(truth.time_s[rows[out + found[0]]] - truth.time_s[rows[out]])
            kept.append(bool(len(before)) and matched[rows[out + found[0]]] == before[-1])
    return OcclusionScores(
        recall=float((matched[covered] >= 0).mean()) if covered.any() else np.nan,
        reacquisition_s=float(np.median(waits)) if waits else np.nan,
        kept_identity=float(np.mean(kept)) if kept else np.nan,
        episodes=episodes,
    )
