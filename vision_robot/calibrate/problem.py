"""What the solver is given: corners, which unknowns are free, and what is known beforehand."""

from dataclasses import dataclass, replace

import numpy as np

from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.weighting import UNDOUBTED, Trust
from vision_robot.types import Array, Bool, Float

__all__ = ["Problem"]


@dataclass(frozen=True)
class Problem:
    """Corners and the free shared parameters.

    `prior_mean` and `prior_information` (1/sigma^2, in units of the corners' variance of
    unit weight) have an entry for each shared parameter; no information is no prior.
    """

    seen: Observations
    free: Bool[Array, "s"]
    prior_mean: Float[Array, "s"]
    prior_information: Float[Array, "s"]
    trust: Trust = UNDOUBTED
    """What the weights of `seen` were made from."""

    @classmethod
    def plain(cls, seen: Observations, free: Bool[Array, "s"]) -> "Problem":
        """Without anything known beforehand."""
        return cls(seen, np.asarray(free, dtype=bool), np.zeros(len(free)), np.zeros(len(free)))

    def of(self, seen: Observations) -> "Problem":
        """The same question asked of other corners."""
        return replace(self, seen=seen)

    def trusting(self, trust: Trust) -> "Problem":
        """The same corners, weighed by how far the detector's word is trusted."""
        weight = np.where(self.seen.present, 1 / trust.sigma(self.seen.sigma_px), 0.0)
        return replace(self, seen=self.seen.with_weight(weight), trust=trust)

    def freeing(self, free: Bool[Array, "s"]) -> "Problem":
        """The same corners with other parameters free."""
        return replace(self, free=free)

    @property
    def degrees_of_freedom(self) -> int:
        """Measured numbers less estimated ones."""
        measured = 2 * int(np.count_nonzero(self.seen.weight))
        measured += int(np.count_nonzero(self.prior_information[self.free]))
        return measured - int(self.free.sum()) - 6 * self.seen.views
