"""A hand-eye calibration beside the truth."""

from dataclasses import dataclass

import numpy as np

from vision_robot.geometry import SE3
from vision_robot.geometry.hand_eye import HandEye
from vision_robot.types import Array, Float

__all__ = ["HandEyeError", "hand_eye_error"]


@dataclass(frozen=True)
class HandEyeError:
    """Found less true: `step` (12,) of (w [rad], dt [m]) of mount_from_cam, then of far_from_board.

    `in_sigma` divides by the stated sigmas; `chance` is that of a larger joint error of mount_from_cam
    if the covariance is right.
    """

    step: Float[Array, "12"]
    in_sigma: Float[Array, "12"]
    chance: float

    @property
    def position_m(self) -> float:
        """Of the camera [m]."""
        return float(np.linalg.norm(self.step[3:6]))

    @property
    def turn(self) -> float:
        """Of the camera [rad]."""
        return float(np.linalg.norm(self.step[:3]))


def hand_eye_error(found: HandEye, truth: HandEye) -> HandEyeError:
    """Compare two calibrations of one set-up."""
    from scipy.special import chdtrc

    step = np.concatenate([_step(found.mount_from_cam, truth.mount_from_cam),
                           _step(found.far_from_board, truth.far_from_board)])  # fmt: skip
    sigma = np.sqrt(np.diag(found.covariance))
    scaled = step / np.where(sigma > 0, sigma, np.inf)
    part = found.covariance[:6, :6] / np.outer(sigma[:6], sigma[:6]) if sigma[:6].all() else np.eye(6)
    square = float(scaled[:6] @ np.linalg.solve(part, scaled[:6]))
    return HandEyeError(step, scaled, float(chdtrc(6, square)))


def _step(found: SE3, truth: SE3) -> Float[Array, "6"]:
    """(w, dt) that carries the truth to what was found."""
    turn = SE3(found.rotation @ truth.rotation.T, np.zeros(3)).rotvec()
    return np.concatenate([turn, found.translation - truth.translation])
