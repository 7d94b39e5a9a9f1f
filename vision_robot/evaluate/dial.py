"""One difficulty turned up step by step: the scenes of a dial."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.evaluate.conclusion import severity_curve
from vision_robot.evaluate.metrics import metric_named
from vision_robot.evaluate.statistics import Breakdown, breakdown_point
from vision_robot.evaluate.sweep import Outcome
from vision_robot.types import Array, Float

__all__ = ["Dial", "dials_of", "measured", "scene_at"]


@dataclass(frozen=True)
class Dial:
    """Scenes ``name=severity`` of rising severity."""

    name: str
    severities: tuple[float, ...]
    scenes: tuple[str, ...]


def scene_at(name: str, severity: float) -> str:
    """How a scene of a dial is called."""
    return f"{name}={severity:g}"


def dials_of(scenes: Sequence[str]) -> list[Dial]:
    """The dials among names of scenes, those with two severities or more."""
    found: dict[str, dict[float, str]] = {}
    for scene in scenes:
        name, equals, severity = scene.rpartition("=")
        if equals:
            found.setdefault(name, {})[float(severity)] = scene
    return [
        Dial(name, tuple(sorted(steps)), tuple(steps[s] for s in sorted(steps)))
        for name, steps in found.items()
        if len(steps) > 1
    ]


def measured(
    dial: Dial, outcomes: Sequence[Outcome], metric: str, method: str, *, threshold: float = 0.5
) -> tuple[Float[Array, "k"], Float[Array, "seeds k"], Breakdown] | None:
    """Severities, scores by seed and breakdown point of one method; None where it took no part.

    It breaks where its mean falls under `threshold`, or rises over it where lower is better.
    """
    severities = np.array(dial.severities)
    scores = severity_curve(outcomes, metric, method, dial.scenes)
    if not len(scores):
        return None
    sign = 1 if metric_named(metric).better == "higher" else -1
    return severities, scores, breakdown_point(severities, sign * scores, threshold=sign * threshold)
