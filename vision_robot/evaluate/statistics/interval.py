"""Confidence intervals: bootstrap over seeds, Wilson for shares."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from statistics import NormalDist

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float, Int

__all__ = ["Interval", "clustered_interval", "wilson_interval"]

RESAMPLES = 4000


@dataclass(frozen=True)
class Interval:
    """A value and the ends of its confidence interval; the ends are NaN where n is too small for one."""

    value: float
    low: float
    high: float
    n: int


def clustered_interval(
    values: Float[Array, "n"],
    clusters: Array,
    *,
    confidence: float = 0.95,
    statistic: Callable[..., Array] = np.mean,
    seed: int = 0,
) -> Interval:
    """Bootstrap interval of a statistic of cluster means, whole clusters drawn anew.

    Scenes of one seed share their objects and light, so that they are one observation and not
    many: `clusters` (n,) names what each value belongs to. NaN values are left out. Bias-corrected
    and accelerated (Efron 1987) from 8 clusters on; Student's t below, where a bootstrap is too narrow
    (and only for the mean).
    """
    known = np.isfinite(values)
    names, place = np.unique(np.asarray(clusters)[known], return_inverse=True)
    k = len(names)
    if k == 0:
        return Interval(np.nan, np.nan, np.nan, 0)
    means = np.bincount(place, weights=values[known]) / np.bincount(place)
    value = float(statistic(means))
    if k == 1:
        return Interval(value, np.nan, np.nan, 1)
    if np.ptp(means) == 0:
        return Interval(value, value, value, k)
    if k < 8 and statistic is np.mean:
        from scipy.stats import t

        half = float(t.ppf((1 + confidence) / 2, k - 1) * means.std(ddof=1) / np.sqrt(k))
        return Interval(value, value - half, value + half, k)
    resampled = np.sort(statistic(means[_draws(k, seed)], axis=1))
    low, high = _corrected_levels(resampled, value, means, statistic, confidence)
    ends = np.quantile(resampled, (low, high))
    return Interval(value, float(ends[0]), float(ends[1]), k)


@cache
def _draws(k: int, seed: int) -> Int[Array, "n k"]:
    return np.random.default_rng(seed).integers(k, size=(RESAMPLES, k))


def _corrected_levels(
    resampled: Array, value: float, means: Array, statistic: Callable[..., Array], confidence: float
) -> tuple[float, float]:
    """The two quantiles of the resampled statistic that bias and skewness call for (Efron 1987)."""
    normal = NormalDist()
    below = (np.sum(resampled < value) + 0.5 * np.sum(resampled == value)) / len(resampled)
    bias = normal.inv_cdf(float(np.clip(below, 1e-4, 1 - 1e-4)))
    if statistic is np.mean:
        without = (means.sum() - means) / (len(means) - 1)
    else:
        without = np.array([statistic(np.delete(means, i)) for i in range(len(means))])
    spread = without.mean() - without
    total = float((spread**2).sum())
    acceleration = float((spread**3).sum()) / (6 * total**1.5) if total > 0 else 0.0

    def level(quantile: float) -> float:
        z = bias + normal.inv_cdf(quantile)
        return normal.cdf(bias + z / (1 - acceleration * z))

    return level((1 - confidence) / 2), level((1 + confidence) / 2)


def wilson_interval(successes: int, trials: int, *, confidence: float = 0.95) -> Interval:
    """Interval of a probability from independent trials (Wilson 1927), honest at 0 and 1 too."""
    if not 0 <= successes <= trials:
        raise BadParameter("successes", successes, f"from 0 to the number of trials, {trials}")
    if trials == 0:
        return Interval(np.nan, np.nan, np.nan, 0)
    z = NormalDist().inv_cdf((1 + confidence) / 2)
    share, scale = successes / trials, 1 + z * z / trials
    centre = (share + z * z / (2 * trials)) / scale
    half = z / scale * np.sqrt(share * (1 - share) / trials + z * z / (4 * trials**2))
    return Interval(share, max(0.0, float(centre - half)), min(1.0, float(centre + half)), trials)
