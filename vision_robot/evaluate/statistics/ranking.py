"""Many methods on many data: average ranks and which of them cannot be told apart."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from vision_robot.evaluate.statistics.paired import holm, sign_flip_p
from vision_robot.types import Array, Bool, Float

__all__ = ["Ranking", "rank_methods"]


@dataclass(frozen=True)
class Ranking:
    """Methods from best to worst, as a critical-difference diagram shows them (Demsar 2006).

    `ranks` are averages over blocks, 1 the best; `groups` are the maximal runs of methods (start
    and end place, both included) within which no pair differs at the level after Holm's correction.
    """

    methods: tuple[str, ...]
    ranks: Float[Array, "m"]
    p: Float[Array, "m m"]
    groups: tuple[tuple[int, int], ...]
    blocks: int

    @property
    def winner(self) -> str | None:
        """The first method, if it differs from every other; else nobody."""
        tied = [group for group in self.groups if group[0] == 0 and group[1] > 0]
        return None if tied or not self.methods else self.methods[0]


def rank_methods(
    methods: Sequence[str],
    values: Float[Array, "blocks m"],
    clusters: Array,
    *,
    higher_is_better: bool = True,
    level: float = 0.05,
    seed: int = 0,
) -> Ranking:
    """Rank within each block (scene and seed), average, and test all pairs on the values themselves.

    Pairs are compared by `sign_flip_p` over `clusters` (blocks,) and corrected by Holm, which Benavoli,
    Corani & Mangili (2016) recommend over tests on mean ranks, since those depend on who else takes part.
    Blocks where any method has no value are left out.
    """
    from scipy.stats import rankdata

    whole = np.isfinite(values).all(axis=1)
    kept, names = values[whole], np.asarray(clusters)[whole]
    m = len(methods)
    ranks = rankdata(-kept if higher_is_better else kept, axis=1).mean(axis=0) if len(kept) else np.ones(m)
    order = np.argsort(ranks, kind="stable")
    pairs = list(combinations(range(m), 2))
    by_cluster = np.array([kept[names == name].mean(axis=0) for name in np.unique(names)]).reshape(-1, m)
    raw = [sign_flip_p(by_cluster[:, order[a]] - by_cluster[:, order[b]], seed) for a, b in pairs]
    p = np.ones((m, m))
    for (a, b), value in zip(pairs, holm(raw), strict=True):
        p[a, b] = p[b, a] = value
    return Ranking(
        tuple(str(methods[int(i)]) for i in order), ranks[order], p, _groups(p >= level), int(whole.sum())
    )


def _groups(alike: Bool[Array, "m m"]) -> tuple[tuple[int, int], ...]:
    """Maximal runs of neighbours in which every pair is alike."""
    m = len(alike)
    runs = []
    for start in range(m):
        end = start
        while end + 1 < m and alike[start : end + 2, start : end + 2].all():
            end += 1
        if not runs or end > runs[-1][1]:
            runs.append((start, end))
    return tuple(runs)
