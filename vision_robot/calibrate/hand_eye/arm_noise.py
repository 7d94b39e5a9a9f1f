"""How well the arm knows its own poses, told by the views themselves.

The variance of an arm residual is what the pictures leave open, plus the arm's own variance of turns
or of shifts. Both are found by restricted maximum likelihood (Patterson & Thompson 1971; Searle, Casella
& McCulloch 1992, chapter 6), which allows for the unknowns fitted to the same residuals, by Fisher
scoring on their logarithms.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.problem import ArmNoise
from vision_robot.calibrate.hand_eye.reduced import Reduced, Weighed
from vision_robot.types import Array, Float

__all__ = ["LEAST", "NoiseEstimate", "component_information", "estimate_noise"]

LEAST = ArmNoise(1e-6, 1e-6)
"""No arm is better than a microradian and a micrometre; nothing is gained by asking for less."""

MOST = ArmNoise(0.5, 0.5)
SETTLED = 1e-4
ROUNDS = 60


@dataclass(frozen=True)
class NoiseEstimate:
    """The arm's noise and the information matrix of its two variances (turn, shift)."""

    noise: ArmNoise
    information: Float[Array, "2 2"]

    @property
    def relative_sigma(self) -> Float[Array, "2"]:
        """One standard deviation of each sigma as a part of it."""
        scaled = self.information * np.outer(self.noise.variances, self.noise.variances)
        return 0.5 * np.sqrt(np.diag(np.linalg.pinv(scaled)))


def estimate_noise(problem: Reduced, start: ArmNoise) -> NoiseEstimate:
    """The most likely noise of the arm, from a start within a factor of a thousand."""
    log_v = np.log(start.variances)
    low, high = np.log(LEAST.variances), np.log(MOST.variances)
    for _ in range(ROUNDS):
        solved = problem.weighed(_noise(log_v))
        score, information = _score(solved), component_information(solved)
        v = np.exp(log_v)
        scaled = information * np.outer(v, v) + 1e-9 * np.eye(2)
        step = np.clip(np.linalg.solve(scaled, score * v), -1.5, 1.5)
        new = np.clip(log_v + step, low, high)
        settled = np.abs(new - log_v).max() < SETTLED
        log_v = new
        if settled:
            break
    noise = _noise(log_v)
    return NoiseEstimate(noise, component_information(problem.weighed(noise)))


def _noise(log_v: Float[Array, "2"]) -> ArmNoise:
    turn, shift = np.exp(log_v / 2)
    return ArmNoise(float(turn), float(shift))


PARTS = (slice(0, 3), slice(3, 6))


def _score(solved: Weighed) -> Float[Array, "2"]:
    """Derivative of the restricted log-likelihood in each variance."""
    W, WH, C = solved.weight, solved.weighed_design, solved.covariance
    pulled = (W @ solved.left[..., None])[..., 0]
    score = []
    for part in PARTS:
        trace = np.einsum("vii->", W[:, part, part]) - np.einsum("vik,kl,vil->", WH[:, part], C, WH[:, part])
        score.append(0.5 * (np.sum(pulled[:, part] ** 2) - trace))
    return np.array(score)


def component_information(solved: Weighed) -> Float[Array, "2 2"]:
    """Fisher information of the variances: half of tr(P D_j P D_k), P = W - W H C H^T W."""
    W, WH, C = solved.weight, solved.weighed_design, solved.covariance
    folded = [np.einsum("vik,vil->kl", WH[:, part], WH[:, part]) for part in PARTS]
    information = np.empty((2, 2))
    for j, a in enumerate(PARTS):
        for k, b in enumerate(PARTS):
            own = np.sum(W[:, a, b] ** 2)
            crossed = np.einsum("vik,vij,vjl->kl", WH[:, a], W[:, a, b], WH[:, b])
            shared = np.einsum("kl,lk->", C, crossed)
            information[j, k] = 0.5 * (own - 2 * shared + np.trace(C @ folded[j] @ C @ folded[k]))
    return information
