"""How the errors of stages add up: mean products of what each contributes to a miss."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["Moments"]


@dataclass(frozen=True)
class Moments:
    """Of a miss that is a sum of one part for each stage: ``position_m2[i, j] = E[part_i . part_j]``.

    The diagonal is what a stage costs alone; twice an entry off it is what two stages cost, or save,
    together. Calibration and plane save: a plane found with a wrong camera is wrong the other way.
    """

    stages: tuple[str, ...]
    position_m2: Float[Array, "k k"]
    """Of the position in the plane of {S}."""
    yaw_rad2: Float[Array, "k k"]
    floor_m2: float = 0.0
    """What is left when all stages are the truth."""
    rest_m2: float = 0.0
    """What three stages and more do together: nothing, where errors are small."""

    @classmethod
    def mean(cls, all_of_them: Sequence[Self]) -> Self:
        """Over scenes."""
        first = all_of_them[0]
        return cls(
            first.stages,
            np.mean([one.position_m2 for one in all_of_them], axis=0),
            np.mean([one.yaw_rad2 for one in all_of_them], axis=0),
            float(np.mean([one.floor_m2 for one in all_of_them])),
            float(np.mean([one.rest_m2 for one in all_of_them])),
        )

    @classmethod
    def measured(
        cls, stages: Sequence[str], misses: Mapping[frozenset[str], Float[Array, "seeds 3"]]
    ) -> Self:
        """From misses (x [m], y [m], yaw [rad]) with each set of stages replaced by the truth.

        By inclusion and exclusion, so that all entries, floor and rest add up to the mean square as it is.
        """
        every = frozenset(stages)
        position = {true: float((m[:, :2] ** 2).sum(axis=1).mean()) for true, m in misses.items()}
        yaw = {true: float((m[:, 2] ** 2).mean()) for true, m in misses.items()}

        def entries(square: Mapping[frozenset[str], float]) -> Float[Array, "k k"]:
            alone = np.array([square[every - {one}] - square[every] for one in stages])
            matrix = np.diag(alone)
            for i, one in enumerate(stages):
                for j in range(i):
                    both = square[every - {one, stages[j]}] - square[every]
                    matrix[i, j] = matrix[j, i] = 0.5 * (both - alone[i] - alone[j])
            return matrix

        found = entries(position)
        floor = position[every]
        rest = position[frozenset()] - floor - float(found.sum())
        return cls(tuple(stages), found, entries(yaw), floor, rest)

    def rms_m(self, true_stages: Collection[str] = ()) -> float:
        """Root mean square of the position when `true_stages` are the truth; without the `rest`."""
        return float(np.sqrt(max(_left(self.position_m2, self.stages, true_stages) + self.floor_m2, 0.0)))

    def yaw_rms_rad(self, true_stages: Collection[str] = ()) -> float:
        """The same of the turn."""
        return float(np.sqrt(max(_left(self.yaw_rad2, self.stages, true_stages), 0.0)))

    def alone_m(self, stage: str) -> float:
        """Root mean square that a stage costs when all others are the truth."""
        return float(np.sqrt(max(np.diag(self.position_m2)[self.stages.index(stage)], 0.0)))


def _left(matrix: Float[Array, "k k"], stages: Sequence[str], true_stages: Collection[str]) -> float:
    stay = np.array([one not in true_stages for one in stages])
    return float(matrix[np.ix_(stay, stay)].sum())
