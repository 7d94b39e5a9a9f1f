"""From where the exported descent starts: as few joint values as reach every goal drawn inside the limits."""

from dataclasses import dataclass

import numpy as np

from vision_robot.arm import symbolic
from vision_robot.arm.export_c.precision import DOUBLE, Precision
from vision_robot.arm.task import Task
from vision_robot.arm.vectorised import Vectorised
from vision_robot.geometry import SerialChain
from vision_robot.types import Array, Bool, Float, Int

__all__ = ["LAST_PATIENCE", "PATIENCE", "Starts", "covering_starts", "golden_steps", "spread_points"]

PATIENCE = 8
"""Steps in which the error has to halve; five times as many are done at most from one start."""
LAST_PATIENCE = 24
"""The same, for starts beyond the table."""
CANDIDATES = 64
TURN = 2**32


@dataclass(frozen=True)
class Starts:
    """Starts in the order in which they are tried, and what they cost on goals they were not chosen for."""

    q: Float[Array, "k n"]
    goals: int
    """Goals drawn inside the limits for the trial."""
    reached: int
    """Of these, from the starts of the table alone."""
    steps_mean: float
    """Calls of the step for a goal, over all starts tried."""
    steps_most: int


def covering_starts(
    chain: SerialChain,
    task: Task,
    *,
    real: Precision = DOUBLE,
    goals: int = 1000,
    seed: int = 0,
) -> Starts:
    """Choose starts greedily until every one of `goals` goals is reached, then try them on as many others.

    The descent is the one of vr_ik.c with the tolerances of `real`, so that what holds here holds there.
    """
    descent = _Descent(Vectorised(symbolic.lm_step(chain, task)), symbolic.length_scale(chain), real)
    rng = np.random.default_rng(seed)
    candidates = np.vstack([chain.limits.mean(axis=1), spread_points(chain, CANDIDATES - 1)])
    drawn = _goals(chain, goals, rng)
    reached, _ = descent.from_each(candidates, drawn)
    order: list[int] = []
    missing = np.ones(goals, dtype=bool)
    while True:
        gain = reached[:, missing].sum(axis=1)
        best = int(np.argmax(gain))
        if gain[best] == 0 and order:
            break
        order.append(best)
        missing &= ~reached[best]
        if not missing.any():
            break
    chosen = candidates[order]
    ok, calls = descent.from_each(chosen, _goals(chain, goals, rng))
    first = np.where(ok.any(axis=0), np.argmax(ok, axis=0), len(chosen) - 1)
    tried = np.arange(len(chosen))[:, None] <= first
    total = (calls * tried).sum(axis=0)
    return Starts(chosen, goals, int(ok.any(axis=0).sum()), float(total.mean()), int(total.max()))


def spread_points(chain: SerialChain, count: int) -> Float[Array, "count n"]:
    """The first points of `spread` in vr_ik.c: even over the joint ranges, without end."""
    k = np.arange(1, count + 1)[:, None]
    share = (k * golden_steps(len(chain)) % TURN >> 8) / 2**24
    return chain.limits[:, 0] + share * np.diff(chain.limits, axis=1)[:, 0]


def golden_steps(joints: int) -> Int[Array, "n"]:
    """Steps modulo 2^32 of the additive sequence on the generalised golden ratio (Roberts 2018)."""
    ratio = 2.0
    for _ in range(64):
        ratio = (1 + ratio) ** (1 / (joints + 1))
    return np.rint(TURN * ratio ** -np.arange(1.0, joints + 1)).astype(np.int64)


def _goals(chain: SerialChain, count: int, rng: np.random.Generator) -> Float[Array, "12 count"]:
    q = rng.uniform(chain.limits[:, 0], chain.limits[:, 1], (count, len(chain)))
    return chain.base_from_tool(q).as_matrix()[:, :3].reshape(count, 12).T


@dataclass(frozen=True)
class _Descent:
    """`descend` of vr_ik.c, for many pairs of start and goal at once."""

    step: Vectorised
    scale: float
    real: Precision

    def from_each(
        self, starts: Float[Array, "k n"], goals: Float[Array, "12 g"]
    ) -> tuple[Bool[Array, "k g"], Int[Array, "k g"]]:
        """Whether each start reaches each goal, and in how many calls of the step."""
        k, g = len(starts), goals.shape[1]
        reached, calls = self.run(np.repeat(starts, g, axis=0).T, np.tile(goals, k))
        return reached.reshape(k, g), calls.reshape(k, g)

    def run(
        self, q: Float[Array, "n p"], goals: Float[Array, "12 p"]
    ) -> tuple[Bool[Array, "p"], Int[Array, "p"]]:
        """Whether each joint vector reaches its goal, and in how many calls."""
        count = q.shape[1]
        reached, calls = np.zeros(count, dtype=bool), np.ones(count, dtype=int)
        at, before = np.arange(count), np.full(count, np.inf)
        here, error = self.step(q, goals)
        for k in range(5 * PATIENCE):
            following, next_error = self.step(here, goals[:, at])
            calls[at] += 1
            next_cost = self.cost(next_error)
            done = self.within(error) & ~(self.coarse(error) & (next_cost < 0.8 * self.cost(error)))
            stuck = np.zeros(len(at), dtype=bool)
            if k % PATIENCE == PATIENCE - 1:
                stuck = ~done & ~(next_cost < 0.5 * before) & ~self.within(next_error)
                before = next_cost
            reached[at[done]] = True
            on = ~(done | stuck)
            at, before, here, error = at[on], before[on], following[:, on], next_error[:, on]
            if not len(at):
                return reached, calls
        reached[at] = self.within(error)
        return reached, calls

    def within(self, error: Float[Array, "2 p"]) -> Bool[Array, "p"]:
        """Near enough."""
        return (error[0] <= self.real.reached_m) & (error[1] <= self.real.reached_rad)

    def coarse(self, error: Float[Array, "2 p"]) -> Bool[Array, "p"]:
        """Worth another step."""
        return ~((error[0] <= self.real.fine_m) & (error[1] <= self.real.fine_rad))

    def cost(self, error: Float[Array, "2 p"]) -> Float[Array, "p"]:
        """Squared distance, angles times the length scale."""
        return error[0] ** 2 + (self.scale * error[1]) ** 2
