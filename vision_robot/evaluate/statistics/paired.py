"""Is one method better than another on the same seeds, and by how much."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.evaluate.statistics.interval import Interval, clustered_interval
from vision_robot.types import Array, Float

__all__ = ["PairedTest", "compare_pairs", "holm", "sign_flip_p"]

EXACT = 14
"""Up to so many clusters all sign changes are tried; above, as many as `DRAWS` by chance."""
DRAWS = 20_000


@dataclass(frozen=True)
class PairedTest:
    """Mean difference of two methods over the seeds they share, with what can be said about it."""

    difference: Interval
    p: float
    """Chance of a difference at least as large if the methods were interchangeable."""
    equivalent: bool
    """Whether the 1 - 2 level interval of the difference lies inside the zone of practical equivalence."""


def compare_pairs(
    ours: Float[Array, "n"],
    theirs: Float[Array, "n"],
    clusters: Array,
    *,
    zone: float = 0.0,
    level: float = 0.05,
    seed: int = 0,
) -> PairedTest:
    """Permutation test on the signs of the clusters' mean differences (Fisher 1935), two-sided.

    `zone` is the largest difference that matters to nobody; two one-sided tests at `level` (Schuirmann
    1987) show equivalence. Pairs with a NaN on either side are left out.
    """
    if not len(ours) == len(theirs) == len(clusters):
        raise BadParameter("pairs", (len(ours), len(theirs), len(clusters)), "the same number of each")
    known = np.isfinite(ours) & np.isfinite(theirs)
    names, place = np.unique(np.asarray(clusters)[known], return_inverse=True)
    k = len(names)
    off = np.zeros(0)
    if k:
        off = np.bincount(place, weights=(ours - theirs)[known]) / np.bincount(place)
    order = np.arange(k)
    difference = clustered_interval(off, order, seed=seed)
    equivalent = False
    if abs(difference.value) < zone:
        inner = clustered_interval(off, order, confidence=1 - 2 * level, seed=seed)
        equivalent = bool(-zone < inner.low and inner.high < zone)
    return PairedTest(difference, sign_flip_p(off, seed), equivalent)


def sign_flip_p(off: Float[Array, "k"], seed: int = 0) -> float:
    """Chance of a sum at least as far from zero if each of the k differences had either sign."""
    k = len(off)
    if k == 0:
        return 1.0
    observed = abs(off.sum())
    slack = 1e-12 * np.abs(off).sum()
    if k <= EXACT:
        return float(np.mean(np.abs(_signs(k) @ off) >= observed - slack))
    signs = np.random.default_rng(seed).integers(0, 2, size=(DRAWS, k)) * 2.0 - 1.0
    reached = int(np.sum(np.abs(signs @ off) >= observed - slack))
    return (reached + 1) / (DRAWS + 1)


@cache
def _signs(k: int) -> Float[Array, "n k"]:
    """All choices of signs; of two opposite ones only one, since sums are taken without their sign."""
    return np.array([(1.0, *rest) for rest in product((-1.0, 1.0), repeat=k - 1)])


def holm(p: Sequence[float]) -> Float[Array, "m"]:
    """p-values adjusted so that all of them together keep their level (Holm 1979)."""
    values = np.asarray(p, dtype=float)
    order = np.argsort(values)
    raised = np.maximum.accumulate(values[order] * np.arange(len(values), 0, -1))
    adjusted = np.empty_like(values)
    adjusted[order] = np.minimum(raised, 1.0)
    return adjusted
