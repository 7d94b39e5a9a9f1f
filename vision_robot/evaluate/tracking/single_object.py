"""Success and precision of one object followed (Wu, Lim & Yang 2013, the OTB benchmark)."""

from dataclasses import dataclass

import numpy as np

from vision_robot.evaluate.tracking.encounters import Encounters
from vision_robot.evaluate.tracking.overlap import box_overlap
from vision_robot.types import Array, Float

__all__ = ["SingleObjectScores", "single_object_scores"]

OVERLAPS = np.linspace(0, 1, 21)
DISTANCES_PX = np.arange(51.0)


@dataclass(frozen=True)
class SingleObjectScores:
    """Share of the object's frames where overlap exceeds, and distance does not exceed, each threshold."""

    success: Float[Array, "21"]
    precision: Float[Array, "51"]

    @property
    def success_auc(self) -> float:
        """Mean of `success` over the overlaps 0, 0.05 ... 1, in [0, 20/21], best high."""
        return float(self.success.mean())

    @property
    def precision_auc(self) -> float:
        """Mean of `precision` over 0 ... 50 px, in [0, 1], best 1."""
        return float(self.precision.mean())

    @property
    def precision_20(self) -> float:
        """Share of frames within 20 px, the figure OTB quotes."""
        return float(self.precision[20])


def single_object_scores(seen: Encounters, object_id: int) -> SingleObjectScores:
    """How well the answer follows the object of truth id `object_id`.

    In each frame the answer's row of greatest overlap is taken, whatever its id, else the nearest:
    this asks where, not who (`identity_scores` asks who). A frame without any answer is a failure at
    every threshold.
    """
    number = int(np.searchsorted(seen.truth.ids, object_id))
    overlap, distance = [], []
    for ids, here, there in zip(seen.truth_ids, seen.truth_rows, seen.answer_rows, strict=True):
        for row in here[ids == number]:
            apart = np.linalg.norm(seen.answer.centroid_px[there] - seen.truth.centroid_px[row], axis=1)
            shared = box_overlap(seen.truth.box_px[row][None], seen.answer.box_px[there])[0]
            overlap.append(shared.max(initial=-1.0))
            best = shared.argmax() if shared.max(initial=0.0) > 0 else apart.argmin() if len(apart) else None
            distance.append(np.inf if best is None else apart[best])
    return SingleObjectScores(
        success=_share(np.array(overlap)[:, None] > OVERLAPS),
        precision=_share(np.array(distance)[:, None] <= DISTANCES_PX),
    )


def _share(reached: Array) -> Array:
    return reached.mean(axis=0) if len(reached) else np.full(reached.shape[1], np.nan)
