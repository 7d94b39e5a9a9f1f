"""At what severity a method breaks."""

from dataclasses import dataclass

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["Breakdown", "breakdown_point"]

RESAMPLES = 1000


@dataclass(frozen=True)
class Breakdown:
    """Severity at which the mean score first falls under the threshold, with a 95 % interval over seeds.

    Infinite where it never does within the severities tried, the lowest severity where it starts under it.
    """

    severity: float
    low: float
    high: float
    seeds: int


def breakdown_point(
    severities: Float[Array, "k"],
    scores: Float[Array, "seeds k"],
    *,
    threshold: float = 0.5,
    seed: int = 0,
) -> Breakdown:
    """First crossing of the mean curve, linear between the severities tried (rising order).

    The mean is first made to fall with severity (pool adjacent violators), so that one lucky score
    far out does not move the point. Seeds are drawn anew for the interval.
    """
    draws = np.random.default_rng(seed).integers(len(scores), size=(RESAMPLES, len(scores)))
    points = [_crossing(severities, scores[draw].mean(axis=0), threshold) for draw in draws]
    # Infinite points are kept as such: "never" is an answer, and nearest ranks do not average with it.
    low, high = np.quantile(points, (0.025, 0.975), method="nearest")
    return Breakdown(
        _crossing(severities, scores.mean(axis=0), threshold), float(low), float(high), len(scores)
    )


def _crossing(severities: Array, mean: Array, threshold: float) -> float:
    falling = _falling(mean)
    under = np.flatnonzero(falling < threshold)
    if not len(under):
        return np.inf
    i = int(under[0])
    if i == 0 or not np.isfinite(falling[i]):
        return float(severities[i])
    share = (falling[i - 1] - threshold) / (falling[i - 1] - falling[i])
    return float(severities[i - 1] + share * (severities[i] - severities[i - 1]))


def _falling(values: Array) -> Array:
    """The nearest curve that never rises (Ayer et al. 1955)."""
    blocks: list[list[float]] = []
    for value in values:
        blocks.append([float(value), 1.0])
        while len(blocks) > 1 and blocks[-1][0] > blocks[-2][0]:
            mean, size = blocks.pop()
            before = blocks[-1]
            before[0] = (before[0] * before[1] + mean * size) / (before[1] + size)
            before[1] += size
    return np.concatenate([np.full(int(size), mean) for mean, size in blocks])
