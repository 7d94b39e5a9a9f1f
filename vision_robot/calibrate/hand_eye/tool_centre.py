"""The tool's tip in the wrist, from poses at which it touches points of the board.

With the board's place in the base known from the camera, each touch says
``base_from_wrist p = base_from_board b``. The board's place enters as an unknown with its covariance, so that
touches refine it too; the arm errs at every touch by the noise that the hand-eye calibration found.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.result import HandEyeResult
from vision_robot.calibrate.hand_eye.state import nudged
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, skew
from vision_robot.types import Array, Float

__all__ = ["FEWEST_TOUCHES", "ToolCentre", "tool_centre"]

FEWEST_TOUCHES = 3
ROUNDS = 4


@dataclass(frozen=True)
class ToolCentre:
    """The tip in the wrist's frame [m], its covariance, and how far each touch is off in the base [m].

    `scatter` is how much more the touches scatter than arm and board explain; the covariance is larger
    by its square where it exceeds one.
    """

    point_m: Float[Array, "3"]
    covariance: Float[Array, "3 3"]
    residuals_m: Float[Array, "n 3"]
    scatter: float

    @property
    def sigma_m(self) -> Float[Array, "3"]:
        """One standard deviation per axis of the wrist."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def rms_m(self) -> float:
        """Root mean square distance of the touches from their points."""
        return float(np.sqrt(np.mean(np.sum(self.residuals_m**2, axis=1))))


def tool_centre(
    result: HandEyeResult, base_from_wrist: SE3, touched_in_board: Float[Array, "n 3"]
) -> ToolCentre:
    """Where the tip is, from three or more touches.

    Args:
        result: A hand-eye calibration whose board stands still (eye-in-hand) and is still in its place.
        base_from_wrist: The arm's pose at each touch, as it says it.
        touched_in_board: The point of the board touched each time [m].

    Raises:
        BadParameter: The board moved with the arm, counts differ, or there are too few touches.
    """
    n = len(base_from_wrist)
    if not result.setup.carries_camera:
        raise BadParameter("set-up", result.setup.name, "eye-in-hand: a carried board cannot be touched")
    if n < FEWEST_TOUCHES or len(touched_in_board) != n:
        counts = (n, len(touched_in_board))
        raise BadParameter("touches: poses and points", counts, f"as many of each, {FEWEST_TOUCHES} or more")
    believed = np.linalg.inv(result.covariance.far_from_board)
    known = np.zeros((9, 9))
    known[3:, 3:] = believed
    unknowns = np.zeros(9)
    for _ in range(ROUNDS):
        left, W, J = _touches(result, base_from_wrist, touched_in_board, unknowns)
        normal = np.einsum("nki,nkl,nlj->ij", J, W, J) + known
        unknowns = unknowns - np.linalg.solve(
            normal, np.einsum("nki,nkl,nl->i", J, W, left) + known @ unknowns
        )
    left, W, J = _touches(result, base_from_wrist, touched_in_board, unknowns)
    square = float(np.einsum("ni,nij,nj->", left, W, left) + unknowns @ known @ unknowns)
    scatter = float(np.sqrt(square / (3 * n - 3)))
    covariance = np.linalg.inv(np.einsum("nki,nkl,nlj->ij", J, W, J) + known)
    return ToolCentre(unknowns[:3], max(1.0, scatter) ** 2 * covariance[:3, :3], left, scatter)


def _touches(
    result: HandEyeResult,
    base_from_wrist: SE3,
    touched_in_board: Float[Array, "n 3"],
    unknowns: Float[Array, "9"],
) -> tuple[Float[Array, "n 3"], Float[Array, "n 3 3"], Float[Array, "n 3 9"]]:
    """How far each touch is off in the base, its weight, derivatives in the tip and the board's (w, dt)."""
    board, noise, R = result.far_from_board, result.noise.noise, base_from_wrist.rotation
    arm = R @ unknowns[:3]
    target = nudged(board, unknowns[3:]).apply(touched_in_board)
    lever = skew(arm)
    V = noise.shift_m**2 * np.eye(3) + noise.turn**2 * lever @ np.swapaxes(lever, 1, 2)
    turned = skew(target - board.translation - unknowns[6:])
    J = np.concatenate([R, turned, np.broadcast_to(-np.eye(3), R.shape)], axis=2)
    return base_from_wrist.translation + arm - target, np.linalg.inv(V), J
