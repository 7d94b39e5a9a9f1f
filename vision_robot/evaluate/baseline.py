"""Is a new run worse than an older one, beyond noise."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from vision_robot.evaluate.metrics import metric_named
from vision_robot.evaluate.score import Score

__all__ = ["Regression", "regressions"]

Z95 = 1.959964


@dataclass(frozen=True)
class Regression:
    """A score that got worse."""

    before: Score
    after: Score
    worse_by: float
    """In the metric's unit, positive."""
    noise: float
    """Half width of the 95 % interval of the difference."""


def regressions(after: Iterable[Score], before: Iterable[Score]) -> list[Regression]:
    """Scores of both runs that are worse now by more than noise and by more than matters, the worst first.

    The runs count as independent (their seeds may differ), so the half widths of their intervals add
    in squares; scores without an interval can show nothing and are passed over.
    """
    older = {_name(score): score for score in before}
    found = []
    for now in after:
        then = older.get(_name(now))
        if then is None:
            continue
        worse = (now.value - then.value) * (1 if now.better == "lower" else -1)
        noise = float(np.hypot(_half(now), _half(then)))
        if worse > max(noise, metric_named(now.metric).zone_at(then.value)):
            found.append(Regression(then, now, worse, noise))
    return sorted(found, key=lambda one: -one.worse_by / max(one.noise, 1e-300))


def _half(score: Score) -> float:
    half = (score.high - score.low) / 2
    return half if np.isfinite(half) else np.inf


def _name(score: Score) -> tuple[str, str, str, str]:
    return score.suite, score.scene, score.method, score.metric
