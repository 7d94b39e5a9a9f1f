"""What the numbers of a hand-eye calibration say, in sentences that each carry the number behind them."""

import numpy as np

from vision_robot.calibrate.hand_eye.judgement.board_scale import BoardScale
from vision_robot.calibrate.hand_eye.judgement.error_budget import HandEyeBudget
from vision_robot.calibrate.hand_eye.judgement.held_out import HeldOutViews
from vision_robot.calibrate.hand_eye.result import HandEyeResult
from vision_robot.calibrate.hand_eye.words import degrees, direction, millimetres, short

__all__ = ["advice", "verdict"]

WEAK_AXIS = 3.0
"""Times one direction is known worse than the best, from which it is worth a word."""

FEW_VIEWS = 10
HELD_BY_PRIOR = 0.7
HONEST = (0.6, 1.5)


def verdict(result: HandEyeResult, budget: HandEyeBudget) -> str:
    """Whether the arm or the camera makes the error, and what would help."""
    noise = result.noise.noise
    arm = f"{millimetres(noise.shift_m)} and {degrees(noise.turn)} per axis"
    whole = millimetres(result.covariance.position_m)
    shares = (
        f"of {whole} of uncertainty in where the camera sits the arm's own error ({arm}) makes "
        f"{millimetres(budget.arm_m)}, the corners ({short(result.noise_px)} px) "
        f"{millimetres(budget.corners_m)}"
    )
    if budget.dominant == "arm":
        return f"the arm dominates: {shares}; sharper pictures will not help, a truer arm or more poses will"
    if budget.dominant == "camera":
        return (
            f"the camera dominates: {shares}; a larger board, sharper pictures or a nearer camera will help, "
            "a better arm will not"
        )
    return f"arm and camera weigh alike: {shares}"


def advice(
    result: HandEyeResult, held_out: HeldOutViews, scale: BoardScale | None, budget: HandEyeBudget
) -> tuple[str, ...]:
    """What is missing or doubtful; nothing when all is well."""
    said = []
    n = len(result.names)
    if n < FEW_VIEWS:
        said.append(f"{n} views are few: the arm's own error {_how_well(result)}; take {FEW_VIEWS} or more")
    values, vectors = np.linalg.eigh(result.covariance.mount_from_cam[3:, 3:])
    if values[-1] > WEAK_AXIS**2 * values[0]:
        along = direction(vectors[:, -1], result.setup.mount)
        said.append(
            f"the camera's position is known worst along {along}, to "
            f"{millimetres(float(np.sqrt(values[-1])))}: turn more about axes across it"
        )
    if scale is not None and scale.doubtful:
        said.append(
            f"the board seems to be {short(scale.scale, 5)} times its stated size (sigma "
            f"{short(scale.sigma)}), or the arm's lengths are off: measure the print"
        )
    if not HONEST[0] < held_out.ratio < HONEST[1]:
        said.append(
            f"held-out views err {short(held_out.ratio)} times as much as foretold: do not trust the sigmas"
        )
    geometry = result.geometry
    if geometry is None and budget.dominant == "arm" and result.noise.noise.shift_m > 3e-4:
        said.append(
            "whether the arm errs by its geometry or by its repeatability shows when joint values and its "
            "model are given (--arm, --geometry)"
        )
    if geometry is not None:
        held = held_by_prior(result)
        if held:
            said.append(
                f"of {geometry.count} combinations of link errors {held} are told by what was believed "
                "before, not by these views: move all joints over their range"
            )
    return tuple(said)


def held_by_prior(result: HandEyeResult) -> int:
    """How many combinations of link errors the views hardly tell."""
    geometry = result.geometry
    if geometry is None:
        return 0
    k = geometry.count
    covariance = result.reduced.weighed(result.noise.noise).covariance[-k:, -k:]
    return int((np.linalg.eigvalsh(covariance) > HELD_BY_PRIOR**2).sum())


def _how_well(result: HandEyeResult) -> str:
    spread = float(result.noise.relative_sigma.max())
    return f"is known to {100 * spread:.0f} % only" if spread < 1 else "cannot be told from them yet"
