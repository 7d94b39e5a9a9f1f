"""Inverse kinematics: joint values for poses of the tool, every reachable one, inside the limits."""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from pathlib import Path

import numpy as np

from vision_robot.arm.compiled_engine import compiled_engine
from vision_robot.arm.engine import Engine, program_of
from vision_robot.arm.goals import goal_rows
from vision_robot.arm.model import Arm
from vision_robot.arm.numpy_engine import SLACK, NumpyEngine, unwound
from vision_robot.arm.solutions import Branches, Solutions
from vision_robot.arm.starts import windows
from vision_robot.arm.task import Task
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3
from vision_robot.types import Array, Bool, Float, Int

__all__ = ["InverseKinematics", "Method", "Tolerance"]

TRIES, STEPS = 60, 15
"""Starts and steps of the first search: all but some in a hundred thousand goals are found by it."""

FEW_TRIES = 24
"""Starts of a search for maps."""

STUBBORN_STEPS = 120
"""Steps of the second search, from every start there is."""


class Method(Enum):
    """How joint values are found."""

    AUTO = "auto"
    """In closed form where the arm has one, numerically where it has none or the form fails."""
    CLOSED_FORM = "closed-form"
    NUMERIC = "numeric"


@dataclass(frozen=True)
class Tolerance:
    """How near the goal counts as reached."""

    position_m: float = 1e-6
    angle_rad: float = 1e-5


class InverseKinematics:
    """Solves for one arm and one task; building it takes some tenths of a second, solving microseconds."""

    def __init__(
        self,
        arm: Arm,
        task: Task = Task.POSE,
        *,
        method: Method = Method.AUTO,
        compiled: bool | None = None,
        tolerance: Tolerance | None = None,
        cache: Path | None = None,
    ):
        """Build the functions; raises UnknownStructure where a closed form is asked for and not known.

        `compiled` True insists on C and False does without; None takes it where a compiler is. `cache` is
        where compiled code is kept.
        """
        self.arm, self.task, self.method = arm, task, method
        self.tolerance = tolerance or Tolerance()
        self.program = program_of(arm.chain, task, arm.nominal)
        if method is Method.CLOSED_FORM and self.program.unknown is not None:
            raise self.program.unknown
        made = compiled_engine(self.program, cache) if compiled is not False else None
        if compiled and made is None:
            raise BadParameter("compiled", compiled, "False or None: no C compiler here can build the solver")
        self.engine: Engine = made or NumpyEngine(self.program)

    @property
    def uses_closed_form(self) -> bool:
        """Whether joint values come from a closed form, at least as the seed."""
        return self.program.closed is not None and self.method is not Method.NUMERIC

    @cached_property
    def _exact(self) -> bool:
        closed = self.program.closed
        return self.uses_closed_form and closed is not None and closed.exact and self.arm.nominal is None

    def solve(self, base_from_tool: SE3, *, near: Float[Array, "... n"] | None = None) -> Solutions:
        """Joint values for each goal pose of the tool in the base.

        Of several branches the one nearest to `near` (joint values, for all goals or one row each), or,
        without it, nearest to the middle of the joints' ranges. A goal not reached gets the joint values
        that come closest. Raises BadGoal.
        """
        goals = goal_rows(base_from_tool, self.arm.chain, self.arm.reach_m)
        present = None if near is None else self._near_rows(near, len(goals))
        if self._exact:
            q, branch = self._from_closed_form(goals, present)
        elif self.uses_closed_form:
            q, branch = self._from_seeds(goals, present)
        else:
            q, branch = self._numeric(goals, present), np.full(len(goals), -1)
        if present is not None:
            q = unwound(q, present, self._periods, self.arm.chain.limits)
        return self._judged(goals, q, branch)

    def sketch(self, base_from_tool: SE3) -> tuple[Float[Array, "goals n"], Bool[Array, "goals"]]:
        """Joint values for each goal and whether they reach it, without dwelling on what looks out of reach.

        For maps of many goals most of which are out of reach: `solve` would look for those at length.
        """
        goals = goal_rows(base_from_tool, self.arm.chain, self.arm.reach_m)
        if self._exact and self.task is Task.POSE:
            q, branch = self._from_closed_form(goals, None, search=False)
            return q, branch >= 0
        q = self.engine.numeric(goals, first=None, tries=FEW_TRIES, iterations=2 * STEPS)
        return q, self.reached(self.engine.errors(goals, q))

    def branches(self, base_from_tool: SE3) -> Branches:
        """All solutions of each goal inside the limits, each joint vector once.

        Those of the closed form, or what the numeric search finds from every start; an arm with joints to
        spare has infinitely many, of which these are some.
        """
        goals = goal_rows(base_from_tool, self.arm.chain, self.arm.reach_m)
        # A closed form answers whole poses: of what a lesser task leaves free it knows one value only.
        if self._exact and self.task is Task.POSE:
            q, errors = self.engine.closed(goals)
        else:
            seeded = self.uses_closed_form and self.task is Task.POSE
            candidates = self._seeds(goals) if seeded else self._searched(goals)
            q = np.clip(candidates, *self.arm.chain.limits.T)
            flat = self._errors(np.repeat(goals, q.shape[1], axis=0), q.reshape(-1, q.shape[2]))
            errors = flat.reshape(*q.shape[:2], 2)
        limits = self.arm.chain.limits
        inside = np.clip(q, *limits.T)
        right = (np.abs(inside - q) <= SLACK).all(axis=2) & self.reached(errors)
        return Branches.of(self.arm.chain.joint_names, inside, errors, right, self._periods)

    def _from_closed_form(
        self, goals: Float[Array, "goals 12"], near: Float[Array, "rows n"] | None, *, search: bool = True
    ) -> tuple[Float[Array, "goals n"], Int[Array, "goals"]]:
        q, _, branch = self.engine.choose(
            goals,
            near=self._middle[None] if near is None else near,
            weights=self._weights if near is not None else 1 / np.maximum(self._range, 1e-9) ** 2,
            periods=self._periods,
            tolerance=(self.tolerance.position_m, self.tolerance.angle_rad),
        )
        left = np.flatnonzero(branch < 0)
        if len(left) and search and self.method is Method.AUTO:
            # Nothing a closed form misses should be reachable; that is not taken on trust.
            first = near if near is None or len(near) == 1 else near[left]
            q[left] = self._numeric(goals[left], first, seeds=q[left])
        return q, branch

    def _from_seeds(
        self, goals: Float[Array, "goals 12"], near: Float[Array, "rows n"] | None
    ) -> tuple[Float[Array, "goals n"], Int[Array, "goals"]]:
        """The nominal closed form, polished on the real chain; what that does not reach is searched for."""
        candidates = self._seeds(goals)
        count, branches, n = candidates.shape
        errors = self._errors(np.repeat(goals, branches, axis=0), candidates.reshape(-1, n))
        right = self.reached(errors).reshape(count, branches)
        if near is not None:
            candidates = unwound(candidates, near[:, None, :], self._periods, self.arm.chain.limits)
        off = candidates - (self._middle if near is None else near[:, None, :])
        weights = 1 / np.maximum(self._range, 1e-9) ** 2 if near is None else self._weights
        cost = np.where(right, off**2 @ weights, np.inf)
        branch = np.where(right.any(axis=1), np.argmin(cost, axis=1), -1)
        q = candidates[np.arange(count), np.maximum(branch, 0)].copy()
        left = np.flatnonzero(branch < 0)
        if len(left) and self.method is Method.AUTO:
            first = near if near is None or len(near) == 1 else near[left]
            q[left] = self._numeric(goals[left], first, seeds=q[left])
        return q, branch

    def _seeds(self, goals: Float[Array, "goals 12"]) -> Float[Array, "goals branches n"]:
        """Every branch of the nominal closed form after Gauss-Newton on the real chain."""
        drawn, _ = self.engine.closed(goals)
        count, branches, n = drawn.shape
        first = np.clip(drawn, *self.arm.chain.limits.T).reshape(-1, n)
        rows = np.repeat(goals, branches, axis=0)
        return self.engine.numeric(rows, first=first, tries=1, iterations=STEPS).reshape(count, branches, n)

    def _numeric(
        self,
        goals: Float[Array, "goals 12"],
        near: Float[Array, "rows n"] | None,
        seeds: Float[Array, "goals n"] | None = None,
    ) -> Float[Array, "goals n"]:
        """Multi-start search, and a longer one for what the first does not reach."""
        first = near if seeds is None else seeds
        if first is not None:
            first = np.clip(np.broadcast_to(first, (len(goals), len(self.arm))), *windows(self.arm.chain).T)
        q = self.engine.numeric(goals, first=first, tries=TRIES, iterations=STEPS)
        left = np.flatnonzero(~self.reached(self.engine.errors(goals, q)))
        if len(left):
            every = len(self.program.starts.q)
            again = self.engine.numeric(
                goals[left], first=q[left], tries=every, iterations=STUBBORN_STEPS, patient=True
            )
            better = self._cost(goals[left], again) < self._cost(goals[left], q[left])
            q[left[better]] = again[better]
        return q

    def _searched(self, goals: Float[Array, "goals 12"]) -> Float[Array, "goals starts n"]:
        """What the search finds from each start by itself."""
        every = self.program.starts.q
        rows = np.repeat(goals, len(every), axis=0)
        first = np.tile(every, (len(goals), 1))
        q = self.engine.numeric(rows, first=first, tries=1, iterations=2 * STEPS)
        return q.reshape(len(goals), len(every), -1)

    def _judged(
        self, goals: Float[Array, "goals 12"], q: Float[Array, "goals n"], branch: Int[Array, "goals"]
    ) -> Solutions:
        """Solutions with errors measured at the joint values given out, never taken from the search."""
        errors = self._errors(goals, q)
        return Solutions(
            joint_names=self.arm.chain.joint_names,
            q=q,
            position_error_m=errors[:, 0],
            orientation_error_rad=errors[:, 1],
            converged=self.reached(errors) & self.arm.chain.within_limits(q),
            branch=branch,
        )

    def _errors(self, goals: Float[Array, "goals 12"], q: Float[Array, "goals n"]) -> Float[Array, "goals 2"]:
        errors = self.engine.errors(goals, q)
        angle = 2 * np.arcsin(np.minimum(errors[:, 1] / 2, 1))  # engines measure the chord
        return np.stack([errors[:, 0], angle], axis=1)

    def reached(self, errors: Float[Array, "*goals 2"]) -> Bool[Array, "*goals"]:
        """Whether distance [m] and angle [rad] are within tolerance."""
        return (errors[..., 0] < self.tolerance.position_m) & (errors[..., 1] < self.tolerance.angle_rad)

    def _cost(self, goals: Float[Array, "goals 12"], q: Float[Array, "goals n"]) -> Float[Array, "goals"]:
        errors = self.engine.errors(goals, q)
        return errors[:, 0] ** 2 + (self.program.scale * errors[:, 1]) ** 2

    def _near_rows(self, near: Float[Array, "... n"], goals: int) -> Float[Array, "rows n"]:
        rows = np.atleast_2d(np.asarray(near, dtype=float))
        if rows.shape not in ((1, len(self.arm)), (goals, len(self.arm))) or not np.isfinite(rows).all():
            allowed = f"{len(self.arm)} finite joint values, or one such row for each goal"
            raise BadParameter("near", rows.shape, allowed)
        return rows

    @cached_property
    def _middle(self) -> Float[Array, "n"]:
        return self.arm.chain.limits.mean(axis=1)

    @cached_property
    def _range(self) -> Float[Array, "n"]:
        return np.diff(self.arm.chain.limits, axis=1)[:, 0]

    @cached_property
    def _weights(self) -> Float[Array, "n"]:
        """A metre of a slide counts as far as it moves a turning link of the arm's length scale."""
        return np.where(self.arm.chain.slides, 1 / self.program.scale**2, 1.0)

    @cached_property
    def _periods(self) -> Float[Array, "n"]:
        """A whole turn for joints that can turn farther than that, else zero."""
        return np.where(~self.arm.chain.slides & (self._range > 2 * np.pi + 1e-6), 2 * np.pi, 0.0)
