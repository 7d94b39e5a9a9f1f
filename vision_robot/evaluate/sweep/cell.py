"""One measurement of a sweep, and what came of it."""

import errno
import hashlib
import importlib
import json
import resource
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import vision_robot
from vision_robot.errors import BadParameter, MissingOpenGL, UnwritableOutput
from vision_robot.machine.hardware import this_machine

__all__ = ["Cell", "Measured", "Outcome", "measure"]


@dataclass(frozen=True)
class Cell:
    """One method on one scene with one seed: a pure function of what stands here.

    `work` names it as "module:function"; it takes `parameters` (all that JSON can hold) by name, a folder
    `workspace` where what several cells need may be kept, and returns figures by the names of metrics, or
    `Measured` where there is something to see too.
    The key is a hash of all of it (but the folder) and the version, so that a result is found again by
    what it is a result of.
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
class Measured:
    """Figures by metric, and what a person would look at: some frames side by side as a data URI."""

    figures: Mapping[str, float]
    strip: str | None = None

    def __post_init__(self) -> None:
        if self.strip is not None and not self.strip.startswith("data:image/"):
            raise BadParameter("strip", self.strip[:40], "a data:image/... URI")


@dataclass(frozen=True)
class Outcome:
    """What a cell gave: figures by metric, or why it failed."""

    cell: Cell
    figures: Mapping[str, float]
    failure: str | None
    seconds: float
    peak_memory_bytes: int
    """Of the process so far, whatever it did before this cell."""
    strip: str | None = None
    """Some frames side by side, as a data URI."""
    machine: str = ""
    """Where it was measured."""
    cpu_seconds: float | None = None
    """Processor time of the process: less than `seconds` where it had to wait."""


def measure(cell: Cell, workspace: Path) -> Outcome:
    """Do the work; an error becomes an outcome with its reason, since a method that fails is a result too.

    What is the machine's fault and not the method's is raised: UnwritableOutput (a full disk), MissingOpenGL.
    """
    start, cpu = perf_counter(), process_time()
    figures: Mapping[str, float] = {}
    failure, strip = None, None
    try:
        module, name = cell.work.split(":")
        answer = getattr(importlib.import_module(module), name)(workspace=workspace, **cell.parameters)
        found = answer if isinstance(answer, Measured) else Measured(answer)
        figures = {metric: float(value) for metric, value in found.figures.items()}
        strip = found.strip
    except (UnwritableOutput, MissingOpenGL):
        raise
    except Exception as error:
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise UnwritableOutput(workspace, error.strerror or str(error)) from error
        failure = f"{type(error).__name__}: {error}"
    taken = perf_counter() - start
    return Outcome(cell, figures, failure, taken, _peak_memory(), strip, this_machine(), process_time() - cpu)


def _peak_memory() -> int:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else 1024 * peak
