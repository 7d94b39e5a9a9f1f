"""Many episodes in a few numbers, each with its interval."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.pick.causes import ending_of
from vision_robot.pick.episode import RUNGS, Episode

__all__ = ["Spread", "Summary", "summary_of"]


@dataclass(frozen=True)
class Spread:
    """Median and 95th percentile; NaN where there was nothing to measure."""

    median: float
    p95: float

    @classmethod
    def of(cls, values: Sequence[float]) -> "Spread":
        """Of the numbers among `values`."""
        known = np.array([value for value in values if np.isfinite(value)])
        if not len(known):
            return cls(np.nan, np.nan)
        return cls(float(np.median(known)), float(np.percentile(known, 95)))


@dataclass(frozen=True)
class Summary:
    """Counts of episodes by rung, and errors at closing and after placing."""

    episodes: int
    reached_rung: dict[str, int]
    """How many got at least there."""
    position_m: Spread
    yaw_rad: Spread
    placing_m: Spread
    placing_yaw_rad: Spread
    seconds: Spread
    pick_seconds: Spread
    cleared: int
    """Things in the way that were put aside."""
    endings: dict[str, int]
    """How many ended short of success, by why."""
    looks: Spread


def summary_of(episodes: Sequence[Episode]) -> Summary:
    """Rungs and spreads of episodes."""
    closing = [episode.closing for episode in episodes if episode.closing]
    placing = [episode.placing for episode in episodes if episode.placing]
    return Summary(
        episodes=len(episodes),
        reached_rung={rung: sum(bool(getattr(one, rung)) for one in episodes) for rung in RUNGS},
        position_m=Spread.of([miss.position_m for miss in closing]),
        yaw_rad=Spread.of([abs(miss.yaw_rad) for miss in closing]),
        placing_m=Spread.of([miss.position_m for miss in placing]),
        placing_yaw_rad=Spread.of([abs(miss.yaw_rad) for miss in placing]),
        seconds=Spread.of([one.seconds for one in episodes]),
        pick_seconds=Spread.of([one.pick_seconds for one in episodes]),
        cleared=sum(one.cleared for one in episodes),
        endings=dict(Counter(ending for one in episodes if (ending := ending_of(one)))),
        looks=Spread.of([float(one.looks) for one in episodes if one.looks]),
    )
