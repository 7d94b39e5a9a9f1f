"""What a suite is, and which there are."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any

from vision_robot.errors import BadParameter
from vision_robot.evaluate.claim import Claim
from vision_robot.evaluate.sweep import Cell

__all__ = ["SUITES", "Plan", "Suite", "suite_named"]


@dataclass(frozen=True)
class Plan:
    """How much of a suite is run; empty means all, None the suite's own choice."""

    scenes: tuple[str, ...] = ()
    methods: tuple[str, ...] = ()
    seeds: int = 12
    first_seed: int = 0
    frames: int | None = None
    size: tuple[int, int] | None = None
    quick: bool = False
    """Fewer scenes, methods and frames: a look in minutes."""
    programs: Mapping[str, str] = field(default_factory=dict)
    """Further methods of suite trackers, by name: command lines with the places {video} and {out}."""

    def __post_init__(self) -> None:
        for name in ("seeds", "frames"):
            value = getattr(self, name)
            if value is not None and value < 1:
                raise BadParameter(name, value, "a whole number from 1 on")
        if self.first_seed < 0:
            raise BadParameter("seed", self.first_seed, "zero or a positive whole number")

    @property
    def seed_range(self) -> range:
        """The seeds."""
        return range(self.first_seed, self.first_seed + self.seeds)


@dataclass(frozen=True)
class Suite:
    """Cells for a plan, and what its page ranks by."""

    name: str
    scenes: tuple[str, ...]
    methods: tuple[str, ...]
    metric: str
    """Ranks methods."""
    threshold: float
    """Of `metric`, under which a method counts as broken on a dial."""
    cells: Callable[[Plan], Sequence[Cell]]
    on_data: Callable[[Path], "Suite"] | None = None
    """The suite on a folder of one's own data; each sequence is a scene and, as its number, a seed."""
    timing: str = ""
    """How its times are measured, where that is not the usual way; for the page."""
    axes: Mapping[str, str] = field(default_factory=dict)
    """What the severities of each dial are, in words; for the page."""

    claims: tuple[Claim, ...] = ()
    """Sentences of others that its runs are asked about."""

    video_of: Callable[[Cell], Mapping[str, Any] | None] | None = None
    """What a cell asks `rendered_set` for, where sets are to be removed after their last cell."""

    def chosen(self, plan: Plan) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Scenes and methods of a plan. Raises BadParameter for names the suite lacks, listing its own."""
        for what, asked, known in (
            ("scene", plan.scenes, self.scenes),
            ("method", plan.methods, (*self.methods, *plan.programs)),
        ):
            for name in asked:
                if name not in known:
                    raise BadParameter(f"{what} of suite {self.name}", name, f"one of {', '.join(known)}")
        return plan.scenes or self.scenes, plan.methods or (*self.methods, *plan.programs)


SUITES = {
    "calibration": "vision_robot_synth.suites.calibration:SUITE",
    "trackers": "vision_robot_synth.suites.trackers:SUITE",
    "flow": "vision_robot_synth.suites.flow:SUITE",
    "ik": "vision_robot_synth.suites.ik:SUITE",
    "grasp": "vision_robot_synth.suites.grasp:SUITE",
}
"""Name -> where the suite is."""


def suite_named(name: str, data: Path | None = None) -> Suite:
    """The suite of that name, on `data` where that is given. Raises BadParameter, listing the known."""
    if name not in SUITES:
        raise BadParameter("suite", name, f"one of {', '.join(SUITES)}")
    module, attribute = SUITES[name].split(":")
    suite: Suite = getattr(import_module(module), attribute)
    if data is None:
        return suite
    if suite.on_data is None:
        raise BadParameter("--data", str(data), f"left out for suite {name}, which makes its own data")
    return suite.on_data(data)
