"""An arm's functions over many goals in numpy alone."""

import numpy as np

from vision_robot.arm.engine import CLOSE, Engine, Program, Rows
from vision_robot.arm.vectorised import Vectorised
from vision_robot.types import Array, Float, Int

__all__ = ["SLACK", "NumpyEngine", "unwound"]

SLACK = 1e-9
"""Joint values this far past a limit, by rounding, are put onto it [m or rad]."""

CHUNK = 8192
"""Goals carried together; what is done is packed away after every step, so that none waits for another."""

FULL = 256
"""Rows below which another row costs next to nothing."""


def unwound(
    q: Float[Array, "*rows n"],
    near: Float[Array, "*near n"],
    periods: Float[Array, "n"],
    limits: Float[Array, "n 2"],
) -> Float[Array, "*rows n"]:
    """Joints that have a period, moved by whole ones towards `near` as far as the limits let them."""
    turning = periods > 0
    period, (low, high) = np.where(turning, periods, 1.0), limits.T
    turns = np.clip(np.round((near - q) / period), np.ceil((low - q) / period), np.floor((high - q) / period))
    return np.where(turning, q + period * turns, q)


class NumpyEngine(Engine):
    """Runs everywhere."""

    name = "numpy"

    def __init__(self, program: Program):
        self.program = program
        self._step, self._error = Vectorised(program.step), Vectorised(program.error)
        self._patient_step = Vectorised(program.patient_step)
        self._closed = Vectorised(program.closed.function) if program.closed else None

    def numeric(
        self,
        goals: Rows,
        *,
        first: Float[Array, "goals n"] | None,
        tries: int,
        iterations: int,
        patient: bool = False,
    ) -> Float[Array, "goals n"]:
        """See `Engine.numeric`."""
        q = np.empty((len(goals), len(self.program.chain)))
        for start in range(0, len(goals), CHUNK):
            part = slice(start, start + CHUNK)
            begin = None if first is None else first[part]
            q[part] = self._numeric(
                self._patient_step if patient else self._step, goals[part], begin, tries, iterations
            )
        return q

    def _numeric(
        self,
        step: Vectorised,
        goals: Rows,
        first: Float[Array, "goals n"] | None,
        tries: int,
        iterations: int,
    ) -> Float[Array, "goals n"]:
        starts, count = self.program.starts, len(goals)
        best, cost = np.empty((count, len(self.program.chain))), np.full(count, np.inf)
        left, done = np.arange(count), 0
        if first is not None:
            left, done = self._tried(step, goals, left, first, iterations, best, cost), 1
        order = np.empty((0, 0), dtype=int)
        used, wave = 0, 1
        while len(left) and done < tries:
            # Few goals left: more starts of each at once, for a call costs the same for one row or hundreds.
            wave = min(max(wave, FULL // len(left)), tries - done, len(starts.q) - used)
            if wave < 1:
                break
            if used + wave > order.shape[1]:
                order = np.full((count, min(max(4 * (used + wave), 8), len(starts.q))), -1)
                order[left] = starts.nearest(goals[left], order.shape[1])
            begin = starts.q[order[left, used : used + wave]].reshape(-1, len(self.program.chain))
            left = self._tried(step, goals, np.repeat(left, wave), begin, iterations, best, cost)
            used, done, wave = used + wave, done + wave, wave if used < 2 else 3 * wave
        return best

    def _tried(
        self,
        step: Vectorised,
        goals: Rows,
        which: Int[Array, "rows"],
        begin: Float[Array, "rows n"],
        iterations: int,
        best: Float[Array, "goals n"],
        best_cost: Float[Array, "goals"],
    ) -> Int[Array, "left"]:
        """Search from one start a row, `which` being its goal; writes what is found into `best`.

        Returns the goals not yet solved.
        """
        asked = np.unique(which)
        q, goal, at = np.ascontiguousarray(begin.T), np.ascontiguousarray(goals[which].T), which
        for k in range(iterations):
            following, error = step(q, goal)
            close = (error[0] < CLOSE[0]) & (error[1] < CLOSE[1])
            # Backwards: of several starts that arrive together the nearest, the first, is kept.
            best[at[close][::-1]] = following[:, close].T[::-1]
            best_cost[at[close]] = 0
            if k + 1 == iterations:
                self._keep_least(at[~close], q[:, ~close], error[:, ~close], best, best_cost)
                break
            away = best_cost[at] > 0
            if not away.any():
                break
            at, goal, q = at[away], goal[:, away], following[:, away]
        return asked[best_cost[asked] > 0]

    def _keep_least(
        self,
        at: Int[Array, "rows"],
        q: Float[Array, "n rows"],
        error: Float[Array, "2 rows"],
        best: Float[Array, "goals n"],
        best_cost: Float[Array, "goals"],
    ) -> None:
        """Of rows that did not arrive, those that miss by less than what is kept of their goal."""
        cost = error[0] ** 2 + (self.program.scale * error[1]) ** 2
        ranks = np.argsort(-cost, kind="stable")  # the least comes last, and stays
        better = ranks[cost[ranks] < best_cost[at[ranks]]]
        best[at[better]] = q[:, better].T
        np.minimum.at(best_cost, at, cost)

    def errors(self, goals: Rows, q: Float[Array, "goals n"]) -> Float[Array, "goals 2"]:
        """See `Engine.errors`."""
        return self._error(np.ascontiguousarray(q.T), np.ascontiguousarray(goals.T))[0].T

    def closed(
        self, goals: Rows
    ) -> tuple[Float[Array, "goals branches n"], Float[Array, "goals branches 2"]]:
        """See `Engine.closed`."""
        assert self._closed is not None
        assert self.program.closed is not None
        q, errors = self._closed(np.ascontiguousarray(goals.T))
        branches = self.program.closed.branches
        q = q.reshape(branches, -1, len(goals))
        return np.moveaxis(q, 2, 0), np.moveaxis(errors.reshape(branches, 2, -1), 2, 0)

    def choose(
        self,
        goals: Rows,
        *,
        near: Float[Array, "rows n"],
        weights: Float[Array, "n"],
        periods: Float[Array, "n"],
        tolerance: tuple[float, float],
    ) -> tuple[Float[Array, "goals n"], Float[Array, "goals 2"], Int[Array, "goals"]]:
        """See `Engine.choose`."""
        assert self._closed is not None
        assert self.program.closed is not None
        parts = []
        for start in range(0, len(goals), CHUNK):
            part = slice(start, start + CHUNK)
            near_here = near.T if len(near) == 1 else near[part].T
            parts.append(self._choose(goals[part], near_here, weights, periods, tolerance))
        q, errors, branch = (np.concatenate(columns) for columns in zip(*parts, strict=True))
        return q, errors, branch

    def _choose(
        self,
        goals: Rows,
        near: Float[Array, "n rows"],
        weights: Float[Array, "n"],
        periods: Float[Array, "n"],
        tolerance: tuple[float, float],
    ) -> tuple[Float[Array, "goals n"], Float[Array, "goals 2"], Int[Array, "goals"]]:
        assert self._closed is not None
        assert self.program.closed is not None
        branches, (low, high) = self.program.closed.branches, self.program.chain.limits.T[:, :, None]
        q, errors = self._closed(np.ascontiguousarray(goals.T))
        q, errors = q.reshape(branches, len(low), -1), errors.reshape(branches, 2, -1)
        costs, turning = np.empty((branches, len(goals))), periods > 0
        for b in range(branches):
            within = np.clip(q[b], low, high)
            right = (np.abs(q[b] - within) <= SLACK).all(axis=0)
            right &= (errors[b, 0] < tolerance[0]) & (errors[b, 1] < tolerance[1])
            q[b] = within
            if turning.any():
                within = unwound(within.T, near.T, periods, self.program.chain.limits).T
                q[b] = within
            far = weights @ (within - near) ** 2
            miss = errors[b, 0] ** 2 + (self.program.scale * errors[b, 1]) ** 2
            costs[b] = np.where(right, far, 1e12 * (1 + miss))
        which, every = np.argmin(costs, axis=0), np.arange(len(goals))
        branch = np.where(costs[which, every] < 1e12, which, -1)
        return q[which, :, every], errors[which, :, every], branch
