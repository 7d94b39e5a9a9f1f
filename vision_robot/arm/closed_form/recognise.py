"""Which kind of arm a chain is, told from its axes; and its closed form."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vision_robot.arm.closed_form.column_elbow import ColumnElbow
from vision_robot.arm.closed_form.column_scara import ColumnScara
from vision_robot.arm.closed_form.rail_elbow import RailElbow
from vision_robot.arm.closed_form.screws import Screws, screws_of
from vision_robot.arm.closed_form.structure import Structure
from vision_robot.arm.closed_form.subproblems import constant
from vision_robot.arm.closed_form.three_parallel import ThreeParallel
from vision_robot.arm.closed_form.waist_elbow import WaistElbow
from vision_robot.arm.closed_form.wrist_centre import WristCentre
from vision_robot.arm.symbolic import residual
from vision_robot.arm.task import Task
from vision_robot.errors import UnknownStructure
from vision_robot.geometry import SerialChain

if TYPE_CHECKING:
    from casadi import Function

__all__ = ["STRUCTURES", "ClosedForm", "closed_form_of", "structure_of"]

STRUCTURES: tuple[type[Structure], ...] = (
    ColumnScara,
    ColumnElbow,
    RailElbow,
    WaistElbow,
    WristCentre,
    ThreeParallel,
)

EXACT = 1e-9
"""Deviation [rad or m] below which a closed form is exact to what doubles can tell of an arm."""

TOLERANCE = 2e-5
"""Deviation above which an arm is not of the kind: files round angles to 1e-5 (1.5708 for a right angle)."""


@dataclass(frozen=True)
class ClosedForm:
    """All joint values that reach a pose, as one CasADi function."""

    structure: str
    branches: int
    function: "Function"
    """``closed_form(goal) -> q, errors``: pose (12,) to a column (n,) a branch and (2, branches).

    Angles lie within half a turn of the middle of their limits, which are not otherwise looked at; errors
    are distance [m] and angle [rad] between the goal and where each branch really brings the tool. Past
    what can be reached a branch is the nearest of its kind or so, with its error, never a NaN.
    """
    deviation: float
    """How far the arm's axes are from those of its kind [rad or m]."""

    @property
    def exact(self) -> bool:
        """Whether branches need no polishing."""
        return self.deviation < EXACT


def closed_form_of(chain: SerialChain, *, task: Task = Task.POSE) -> ClosedForm:
    """The closed form of a chain whose kind is known. Raises UnknownStructure, with the reason for each kind.

    `task` says what the errors count.
    """
    import casadi as ca

    screws = screws_of(chain)
    structure, deviation = _recognised(screws)
    goal = ca.SX.sym("goal", 12)
    back = screws.home.inverse()
    rotation = ca.vertcat(*(goal[4 * i : 4 * i + 3].T for i in range(3)))
    turn = ca.mtimes(rotation, constant(back.rotation))
    shift = ca.mtimes(rotation, constant(back.translation)) + goal[3::4]
    error = residual(chain, task)
    columns, errors = [], []
    for branch in structure.branches(screws, turn, shift):
        q = ca.densify(ca.vertcat(*_unwound(branch, chain)))
        columns.append(q)
        errors.append(error(q, goal)[2])
    outputs = [ca.horzcat(*columns), ca.densify(ca.horzcat(*errors))]
    function = ca.Function("closed_form", [goal], outputs, ["goal"], ["q", "errors"])
    return ClosedForm(structure.name, len(columns), function, deviation)


def structure_of(chain: SerialChain) -> str:
    """Name of the kind of arm. Raises UnknownStructure."""
    return _recognised(screws_of(chain))[0].name


def _recognised(screws: Screws) -> tuple[type[Structure], float]:
    reasons = {}
    for structure in STRUCTURES:
        if structure.pattern != screws.pattern:
            continue
        conditions = structure.conditions(screws)
        text, worst = max(conditions, key=lambda condition: condition[1])
        if worst < TOLERANCE:
            return structure, worst
        reasons[structure.name] = f"it asks that {text}, which is off by {worst:.2g}"
    raise UnknownStructure(screws.names, screws.pattern, reasons)


def _unwound(branch: Sequence, chain: SerialChain) -> list:
    """Angles in the turn around the middle of their limits."""
    import casadi as ca

    finite = np.where(np.isfinite(chain.limits), chain.limits, 0.0)
    turn, unwound = 2 * np.pi, []
    for q, slides, (low, high) in zip(branch, chain.slides, finite, strict=True):
        middle = (low + high) / 2
        unwound.append(q if slides else q - turn * ca.floor((q - middle) / turn + 0.5))
    return unwound
