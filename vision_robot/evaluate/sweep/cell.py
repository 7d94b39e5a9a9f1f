"""One measurement of a sweep, and what came of it."""

import hashlib
import importlib
import json
import resource
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from time import perf_counter
from typing import Any

import vision_robot
from vision_robot.errors import BadParameter

__all__ = ["Cell", "Outcome", "measure"]


@dataclass(frozen=True)
class Cell:
    """One method on one scene with one seed: a pure function of what stands here.

    `work` names it as "module:function"; it takes `parameters` (all that JSON can hold) by name and
    returns figures by the names of metrics. The key is a hash of all of it and the version, so that a
    result is found again by what it is a result of.
    """

    suite: str
    scene: str
    method: str
    seed: int
    work: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    alone: bool = False
    """Whether it measures time, and must not share the machine with other cells."""

    def __post_init__(self) -> None:
        try:
            self.key  # noqa: B018 - asked for its error
        except (TypeError, ValueError) as error:
            raise BadParameter(
                "cell parameters", dict(self.parameters), "numbers, words, lists and mappings"
            ) from error

    @property
    def key(self) -> str:
        """Name of its result: sixteen hexadecimal digits."""
        content = {**asdict(self), "parameters": dict(self.parameters), "version": vision_robot.__version__}
        text = json.dumps(content, sort_keys=True, allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()[:16]


@dataclass(frozen=True)
class Outcome:
    """What a cell gave: figures by metric, or why it failed."""

    cell: Cell
    figures: Mapping[str, float]
    failure: str | None
    seconds: float
    peak_memory_bytes: int
    """Of the process so far, whatever it did before this cell."""


def measure(cell: Cell) -> Outcome:
    """Do the work; an error becomes an outcome with its reason, since a method that fails is a result too."""
    start = perf_counter()
    figures: Mapping[str, float] = {}
    failure = None
    try:
        module, name = cell.work.split(":")
        work = getattr(importlib.import_module(module), name)
        figures = {metric: float(value) for metric, value in work(**cell.parameters).items()}
    except Exception as error:
        failure = f"{type(error).__name__}: {error}"
    return Outcome(cell, figures, failure, perf_counter() - start, _peak_memory())


def _peak_memory() -> int:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else 1024 * peak
