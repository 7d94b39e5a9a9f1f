"""How sure the parameters are, told by the views themselves: the bootstrap over views.

The covariance of a calibration believes that the model is right and that corners err
independently. Drawing the views anew with replacement (Efron 1979) believes only that views
are independent of each other: what a bent board, a wrong lens or motion does alike to all
corners of a view shows in how the estimate scatters over draws. A draw in which view v
appears w_v times has its minimum one Gauss-Newton step away (`view_blocks`), without a
refit.

With few views such draws scatter too much or too little even when all is right, by an
amount that is known: d(w) then has the covariance E(w) of `ViewBlocks.spread`, where the
estimate itself has C. So the draws of each parameter are put on the scale of its stated
sigma, with little weight on draws that hardly determine it,

    d'(w) = c d(w) sqrt(C / (C + E(w))),    c^2 = 1 / mean E(w) / (C + E(w)),

and ``ratio^2 = mean d'(w)^2 / C`` has the mean one under a right model: it is the factor on
the stated sigma for which the views themselves vouch.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.judgement.solution import solution
from vision_robot.calibrate.judgement.view_blocks import ViewBlocks
from vision_robot.calibrate.normal_equations import normal_equations
from vision_robot.calibrate.refine import arrow_solve
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.calibrate.state import State
from vision_robot.errors import BadParameter, DegenerateViews
from vision_robot.types import Array, Float

__all__ = ["Bootstrap", "bootstrap"]

PROBES = 5
"""Draws of which a second step is taken, to see whether one is enough."""

UNLIKELY = 0.01
IMAGINED = 300


@dataclass(frozen=True)
class Bootstrap:
    """Estimates from views drawn anew.

    `draws` (r, s) are the shared parameters of each draw, their departure from the estimate
    scaled so that under a right model they scatter as the stated covariance says; `ratio`
    (s,) is their scatter over the stated sigma, NaN for what is fixed or undetermined.
    `chance` is how often a right model gives ratios as large, as imagined from the blocks.
    `one_step_error` is how far from the minimum a step ends, as a part of its length: from a
    quarter on, take ratios and intervals as rough.
    """

    views: int
    names: tuple[str, ...]
    estimate: Float[Array, "s"]
    draws: Float[Array, "r s"]
    ratio: Float[Array, "s"]
    chance: float
    one_step_error: float

    @property
    def covariance(self) -> Float[Array, "s s"]:
        """Of the shared parameters, about the estimate; zero for what is fixed."""
        off = self.draws - self.estimate
        return off.T @ off / len(off)

    @property
    def sigma(self) -> Float[Array, "s"]:
        """One standard deviation of each shared parameter."""
        return np.sqrt(np.diag(self.covariance))

    def interval(self, level: float = 0.95) -> Float[Array, "s 2"]:
        """Which holds each parameter with probability `level`.

        `sigma` times Student's t for one less than the views, for so few independent things
        tell sigma (Cameron & Miller 2015, section VI); plain quantiles of the draws hold the
        truth too seldom, 89 % of the time for 95 % of 12 views.
        """
        from scipy.special import stdtrit

        if not 0 < level < 1:
            raise BadParameter("level", level, "between 0 and 1")
        half = stdtrit(self.views - 1, (1 + level) / 2) * self.sigma
        return np.stack([self.estimate - half, self.estimate + half], axis=-1)

    @property
    def typical_ratio(self) -> float:
        """Root mean square of the ratios."""
        return float(np.sqrt(np.nanmean(self.ratio**2)))

    @property
    def honest(self) -> bool:
        """Whether the stated sigmas hold, as far as these views can tell."""
        return self.chance >= UNLIKELY

    @property
    def sentence(self) -> str:
        """The same in words."""
        found = f"views drawn anew scatter {self.typical_ratio:.1f} times as far as the stated sigmas say"
        if self.honest:
            return f"{found}: no model error shows"
        worst = int(np.nanargmax(self.ratio))
        return (
            f"{found}, {self.names[worst]} {self.ratio[worst]:.1f} times: views disagree by more than their "
            "corners' noise; the lens model or the board's shape is wrong, or something moved"
        )


def bootstrap(
    result: CalibrationResult, board_points: Float[Array, "m 3"], *, resamples: int = 200, seed: int = 0
) -> Bootstrap:
    """Draw the views anew `resamples` times; `board_points` (m, 3) [m] as given to `calibrate`.

    Raises DegenerateViews where hardly any draw determines all that the views do.
    """
    if resamples < 2:
        raise BadParameter("resamples", resamples, "two or more")
    blocks = ViewBlocks.of(*solution(result, board_points))
    rng = np.random.default_rng(seed)
    weights = _drawn(blocks, resamples, rng)
    steps = blocks.steps(weights)
    free = np.flatnonzero(blocks.problem.free)
    directions = blocks.parameters(np.eye(steps.shape[1])).T[free]  # f, k
    stated = blocks.variance * np.sum(directions**2, axis=1)
    expected = np.einsum("fk,rkl,fl->rf", directions, blocks.spread(weights), directions)
    damped = np.sqrt(stated / (stated + expected))
    damped /= np.sqrt(np.mean(expected / (stated + expected), axis=0))
    scaled = steps @ directions.T * damped
    imagined = blocks.imagined_steps(weights, IMAGINED, rng) @ directions.T * damped

    names, estimate = blocks.state.shared_names, blocks.state.shared_parameters
    told = ~np.isin(np.array(names)[free], result.covariance.undetermined)
    ratio, draws = np.full(len(names), np.nan), np.tile(estimate, (len(steps), 1))
    draws[:, free] += scaled
    ratio[free[told]] = np.sqrt(np.mean(scaled**2, axis=0) / stated)[told]
    by_chance = np.mean(np.mean(imagined**2, axis=1) / stated, axis=1, where=told)
    chance = float(np.mean(by_chance >= np.nanmean(ratio**2)))
    return Bootstrap(
        blocks.views, names, estimate, draws, ratio, chance, _one_step_error(blocks, weights, steps)
    )


def _drawn(blocks: ViewBlocks, count: int, rng: np.random.Generator) -> Float[Array, "r views"]:
    """How often each view appears in each draw; draws that leave something undetermined are drawn again."""
    views = blocks.views
    kept: list[Array] = []
    for _ in range(10):
        weights = rng.multinomial(views, np.full(views, 1 / views), size=count).astype(float)
        kept.append(weights[blocks.determined(weights)])
        if sum(map(len, kept)) >= count:
            return np.concatenate(kept)[:count]
    raise DegenerateViews(blocks.state.camera.parameter_names, "few draws of these views determine them")


def _one_step_error(blocks: ViewBlocks, weights: Array, steps: Array) -> float:
    """Length of a second Gauss-Newton step over that of the first, the median of a few draws."""
    errors = []
    for weight, step in zip(weights[:PROBES], steps, strict=False):
        problem, used = blocks.weighted(weight), weight > 0
        state = blocks.moved(step)
        state = State(state.camera, state.cam_from_board[used], state.warp)
        try:
            second, _ = arrow_solve(normal_equations(state, problem))
        except np.linalg.LinAlgError:
            second = np.full(len(blocks.directions), np.inf)
        errors.append(np.linalg.norm(blocks.step_of(second)) / max(np.linalg.norm(step), 1e-300))
    return float(np.median(errors))
