"""Poses that noise cannot explain: found one by one, with what is probably wrong with each."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.arm_noise import estimate_noise
from vision_robot.calibrate.hand_eye.pairing import between, other_pose
from vision_robot.calibrate.hand_eye.problem import ArmNoise
from vision_robot.calibrate.hand_eye.reduced import Reduced
from vision_robot.calibrate.hand_eye.start import disagreement
from vision_robot.calibrate.hand_eye.state import HandEyeState
from vision_robot.calibrate.hand_eye.words import degrees, millimetres
from vision_robot.geometry import SE3
from vision_robot.types import Array, Bool, Float

__all__ = ["Surprise", "explained_views", "reason", "surprise"]

CHANCE = 1e-5
"""Chance at which a view of an arm in order would be left out."""

FEWEST_KEPT = 4
CLOSE = 4.0
"""Times the arm's noise within which another pose explains a picture."""


@dataclass(frozen=True)
class Surprise:
    """How far each view is from what the others foretell.

    `off` (n, 6) are turn and shift, `chance` (n,) that noise alone goes as far.
    """

    off: Float[Array, "n 6"]
    chance: Float[Array, "n"]


def explained_views(problem: Reduced, start: Bool[Array, "n"], noise: ArmNoise) -> Bool[Array, "n"]:
    """Which views the noise of the arm explains, from a first guess of them.

    The least likely view is asked against the noise and the unknowns that all the others tell; it is left
    out, and so on, until all are likely. A view that was left out comes back when the rest explains it.
    """
    keep = np.array(start, dtype=bool)
    for _ in range(2 * len(keep)):
        noise = estimate_noise(problem.keeping(keep), noise).noise
        found = surprise(problem, keep, noise).chance
        back = ~keep & (found > np.sqrt(CHANCE))
        if back.any():
            keep = keep | back
            continue
        if keep.sum() <= FEWEST_KEPT:
            break
        without = keep.copy()
        worst = int(np.argmin(np.where(keep, found, np.inf)))
        without[worst] = False
        # The noise must not be told by the view that is asked.
        others = estimate_noise(problem.keeping(without), noise).noise
        if surprise(problem, without, others).chance[worst] >= CHANCE:
            break
        keep = without
    return keep


def surprise(problem: Reduced, keep: Bool[Array, "n"], noise: ArmNoise) -> Surprise:
    """Each view against the fit to the kept ones; those among them against the fit to the rest."""
    from scipy.special import fdtrc

    solved = problem.keeping(keep).weighed(noise)
    left = problem.residual + problem.design @ solved.step
    V = problem.by_pictures + np.diag(np.repeat(noise.variances, 3))
    carried = problem.design @ solved.covariance @ np.swapaxes(problem.design, 1, 2)
    S = V + np.where(keep, -1.0, 1.0)[:, None, None] * carried
    pulled = np.linalg.solve(S, left[..., None])[..., 0]
    square = (left * pulled).sum(axis=1)
    freedom = max(6 * int(keep.sum()) - problem.design.shape[2] - 6, 1)
    # What the others foretell: V S^-1 of what is left over after the view itself has had its say.
    off = np.where(keep[:, None], (V @ pulled[..., None])[..., 0], left)
    return Surprise(off, np.asarray(fdtrc(6, freedom, np.maximum(square, 0) / 6)))


def reason(
    view: int,
    state: HandEyeState,
    every_pose: SE3,
    seen: SE3,
    noise: ArmNoise,
    off: Float[Array, "6"],
    names: Sequence[str],
) -> str:
    """Why a view was left out, in words; `every_pose` are all mount_from_far, `seen` its cam_from_board."""
    turn, shift = float(np.linalg.norm(off[:3])), float(np.linalg.norm(off[3:]))
    said = (
        f"its pose and its picture disagree by {millimetres(shift)} and {degrees(turn)}, the others by "
        f"{millimetres(noise.shift_m)} and {degrees(noise.turn)} per axis"
    )
    close_turn = CLOSE * max(noise.turn, 1e-4)
    close_shift = CLOSE * (
        noise.shift_m + noise.turn * float(np.linalg.norm(every_pose.translation, axis=1).max())
    )
    X, Z = state.mount_from_cam, state.far_from_board
    best, turns, shifts = other_pose(X, Z, every_pose, seen)
    if best != view and turns[best] < close_turn and shifts[best] < close_shift:
        return f"{said}; the picture fits the pose of {names[best]} instead: swapped?"
    for step in (1, -1):
        if not 0 <= view + step < len(every_pose):
            continue
        pair = every_pose[np.array([min(view, view + step), max(view, view + step)])]
        for part in np.arange(0.1, 0.95, 0.1):
            on_the_way = between(pair, float(part) * step)
            turned, shifted = disagreement(X, Z, on_the_way, SE3(seen.rotation[None], seen.translation[None]))
            if turned[0] < close_turn and shifted[0] < close_shift:
                to = "the next pose" if step > 0 else "the last pose"
                return (
                    f"{said}; it was taken about {100 * part:.0f} % of the way to {to}: the arm was moving?"
                )
    return said
