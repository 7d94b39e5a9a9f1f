"""Scores: outcomes of a sweep gathered by scene, method and metric, each with its interval."""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from vision_robot.errors import BadTable
from vision_robot.evaluate.metrics import metric_named
from vision_robot.evaluate.statistics import clustered_interval
from vision_robot.evaluate.sweep import Outcome
from vision_robot.reading import json_tree, read_text

__all__ = ["Failure", "Score", "failures", "read_scores", "scores"]


@dataclass(frozen=True)
class Score:
    """One figure of a benchmark: mean over seeds, ends of its 95 % interval, seeds n."""

    suite: str
    scene: str
    method: str
    metric: str
    value: float
    low: float
    high: float
    unit: str
    better: str
    n: int


@dataclass(frozen=True)
class Failure:
    """A method that gave no figures on a scene, and why."""

    suite: str
    scene: str
    method: str
    seed: int
    reason: str


def scores(outcomes: Iterable[Outcome]) -> list[Score]:
    """One score for each suite, scene, method and metric, in the order they come.

    Seeds are the clusters: several outcomes of one seed count as one. Figures that are not a number
    are left out; where nothing is left there is no score.
    """
    gathered: dict[tuple[str, str, str, str], list[tuple[int, float]]] = defaultdict(list)
    for outcome in outcomes:
        cell = outcome.cell
        for metric, value in outcome.figures.items():
            gathered[cell.suite, cell.scene, cell.method, metric].append((cell.seed, value))
    found = []
    for (suite, scene, method, name), pairs in gathered.items():
        seeds, values = (np.array(column) for column in zip(*pairs, strict=True))
        interval = clustered_interval(values.astype(float), seeds)
        if interval.n:
            metric = metric_named(name)
            low, high = (
                float(np.clip(end, metric.least, metric.most)) for end in (interval.low, interval.high)
            )
            ends = (interval.value, low, high)
            found.append(Score(suite, scene, method, name, *ends, metric.unit, metric.better, interval.n))
    return found


def failures(outcomes: Iterable[Outcome]) -> list[Failure]:
    """What failed, in the order it comes."""
    return [
        Failure(o.cell.suite, o.cell.scene, o.cell.method, o.cell.seed, o.failure)
        for o in outcomes
        if o.failure is not None
    ]


def read_scores(path: Path | str) -> list[Score]:
    """The scores in a file that `vr benchmark --json` wrote. Raises BadTable for anything else."""
    content = json_tree(read_text(path, BadTable), path, BadTable)
    try:
        return [_score(row) for row in content["scores"]]
    except (ValueError, KeyError, TypeError) as error:
        raise BadTable(path, "it holds no scores; give a file that 'vr benchmark --json' wrote") from error


def _score(row: Mapping[str, Any]) -> Score:
    known: dict[str, Any] = {}
    for one in fields(Score):
        value = row[one.name]
        # What JSON has no number for is null there.
        known[one.name] = np.nan if value is None and one.type is float else value
        if not isinstance(known[one.name], int | float if one.type is float else one.type):  # type: ignore[arg-type]
            raise TypeError(one.name)
    return Score(**known)
