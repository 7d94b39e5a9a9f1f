"""What each view says of the shared parameters, once its pose is free to follow.

With the poses eliminated the Gauss-Newton matrix is a sum over views, H = sum_v S_v, and so
is the gradient g = sum_v g_v, which vanishes at the minimum. If view v counted w_v times,
the minimum would lie, to first order, at

    d(w) = -A sum_v w_v g_v,    A = (sum_v w_v S_v)^-1,

so that leaving out views, holding some back and drawing them anew are all sums over the
same small blocks. Under a right model and independent corners of variance s^2, g_v scatters
with s^2 S_v about what the minimum leaves of it, and d(w) has the covariance

    s^2 (A (sum_v w_v^2 S_v) A - H^-1).

Parameters are counted in units in which H is the identity; directions that the views leave
undetermined have no coordinate.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.covariance import NULL
from vision_robot.calibrate.normal_equations import normal_equations
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.refine import Refinement, refine
from vision_robot.calibrate.state import State
from vision_robot.types import Array, Bool, Float

__all__ = ["ViewBlocks"]

MOST_STEPS = 40
"""From a step near the minimum, a model that needs more has no minimum to speak of."""

SINGULAR = 1e-6
"""Share of the information left, below which a choice of views leaves something undetermined."""


@dataclass(frozen=True)
class ViewBlocks:
    """The blocks of a minimum; `directions` (f, k) leads from their units to the free parameters."""

    state: State
    problem: Problem
    information: Float[Array, "views k k"]
    gradient: Float[Array, "views k"]
    prior_information: Float[Array, "k k"]
    prior_gradient: Float[Array, "k"]
    directions: Float[Array, "f k"]
    pose_gain: Float[Array, "views 6 f"]
    """How a view's pose follows the free parameters, with the opposite sign."""
    variance: float
    """Variance of unit weight that the residuals tell."""

    @classmethod
    def of(cls, state: State, problem: Problem) -> "ViewBlocks":
        """Evaluate the blocks at a minimum."""
        S, g, gains, cost = [], [], [], 0.0
        plain = Problem.plain(problem.seen, problem.free)
        for v in range(problem.seen.views):
            one = slice(v, v + 1)
            own = normal_equations(
                State(state.camera, state.cam_from_board[one], state.warp), plain.of(problem.seen[one])
            )
            gain = np.linalg.solve(own.pose[0], own.border[0].T)
            S.append(own.shared - own.border[0] @ gain)
            g.append(own.shared_gradient - own.pose_gradient[0] @ gain)
            gains.append(gain)
            cost += own.cost
        known = problem.prior_information[problem.free]
        off = (state.shared_parameters - problem.prior_mean)[problem.free]
        directions = _whitening(sum(S) + np.diag(known))
        return cls(
            state,
            problem,
            information=directions.T @ np.array(S) @ directions,
            gradient=np.array(g) @ directions,
            prior_information=(directions.T * known) @ directions,
            prior_gradient=directions.T @ (known * off),
            directions=directions,
            pose_gain=np.array(gains),
            variance=(2 * cost + float(known @ off**2)) / max(problem.degrees_of_freedom, 1),
        )

    @property
    def views(self) -> int:
        """How many views."""
        return len(self.gradient)

    def steps(self, weights: Float[Array, "r views"]) -> Float[Array, "r k"]:
        """d(w) for each row of weights; NaN where the weighted views leave something undetermined."""
        inverse = self._inverse(weights)
        gradient = weights @ self.gradient + self.prior_gradient
        return -(inverse @ gradient[..., None])[..., 0]

    def imagined_steps(
        self, weights: Float[Array, "r views"], count: int, rng: np.random.Generator
    ) -> Float[Array, "count r k"]:
        """Steps as they might have come out had the model been right: `count` sets of such views."""
        k = len(self.prior_gradient)
        sources = np.concatenate([self.information, self.prior_information[None]])
        values, vectors = np.linalg.eigh(sources)
        root = vectors * np.sqrt(np.maximum(self.variance * values, 0))[:, None]
        scatter = np.einsum("vkl,cvl->cvk", root, rng.normal(size=(count, len(sources), k)))
        # The minimum of each imagined set lies elsewhere, and gradients are taken there.
        moved = scatter.sum(axis=1)
        scatter -= np.einsum("vkl,cl->cvk", sources, moved)
        counted = np.column_stack([weights, np.ones(len(weights))])
        gradient = np.tensordot(counted, scatter, axes=([1], [1]))  # r, count, k
        return -(gradient @ self._inverse(weights)).transpose(1, 0, 2)

    def spread(self, weights: Float[Array, "r views"]) -> Float[Array, "r k k"]:
        """Covariance of `steps` that a right model predicts."""
        inverse = self._inverse(weights)
        squared = np.tensordot(weights**2, self.information, axes=1) + self.prior_information
        return self.variance * (inverse @ squared @ inverse - np.eye(len(self.prior_gradient)))

    def parameters(self, steps: Float[Array, "r k"]) -> Float[Array, "r s"]:
        """Changes of all shared parameters, zero for those held."""
        change = np.zeros((len(steps), len(self.problem.free)))
        change[:, self.problem.free] = steps @ self.directions.T
        return change

    def moved(self, step: Float[Array, "k"]) -> State:
        """The state after a step, the poses following; unmoved where the step leads to no camera."""
        shared = self.directions @ step
        return self.state.moved(self.problem.free, shared, -self.pose_gain @ shared) or self.state

    def weighted(self, weights: Float[Array, "views"]) -> Problem:
        """The problem in which view v counts weights[v] times; those that count not at all are gone."""
        used, seen = weights > 0, self.problem.seen
        weight = seen.weight[used] * np.sqrt(weights[used])[:, None]
        return self.problem.of(seen[used].with_weight(weight))

    def refitted(
        self, weights: Float[Array, "views"], step: Float[Array, "k"], *, tolerance: float = 0.03
    ) -> Refinement:
        """The minimum itself of the `weighted` problem, by descent from a step towards it.

        Settled to `tolerance` standard deviations. Raises NoConvergence.
        """
        used, start = weights > 0, self.moved(step)
        start = State(start.camera, start.cam_from_board[used], start.warp)
        return refine(start, self.weighted(weights), tolerance=tolerance, max_iterations=MOST_STEPS)

    def step_of(self, change: Float[Array, "f"]) -> Float[Array, "k"]:
        """A change of the free parameters as a step."""
        return np.linalg.lstsq(self.directions, change, rcond=None)[0]

    def determined(self, weights: Float[Array, "r views"]) -> Bool[Array, "r"]:
        """Which weighted sets of views still determine all that these views do."""
        return np.linalg.eigvalsh(self._information(weights))[:, 0] > SINGULAR

    def _information(self, weights: Array) -> Float[Array, "r k k"]:
        return np.tensordot(weights, self.information, axes=1) + self.prior_information

    def _inverse(self, weights: Array) -> Float[Array, "r k k"]:
        values, vectors = np.linalg.eigh(self._information(weights))
        scaled = np.where(values[:, :1] > SINGULAR, 1 / np.maximum(values, SINGULAR), np.nan)
        return (vectors * scaled[:, None]) @ vectors.transpose(0, 2, 1)


def _whitening(H: Float[Array, "f f"]) -> Float[Array, "f k"]:
    """T with T^T H T = I over the directions in which H knows anything."""
    scale = 1 / np.sqrt(np.maximum(np.diag(H), 1e-300))
    values, vectors = np.linalg.eigh(H * scale[:, None] * scale)
    known = values > NULL
    return scale[:, None] * vectors[:, known] / np.sqrt(values[known])
