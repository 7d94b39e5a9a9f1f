"""How well the hand-eye transform is known, with the freedom that the arm's estimated noise leaves."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.arm_noise import NoiseEstimate
from vision_robot.calibrate.hand_eye.reduced import Weighed
from vision_robot.calibrate.hand_eye.setup import Setup
from vision_robot.types import Array, Float

__all__ = ["HandEyeCovariance", "hand_eye_covariance"]


@dataclass(frozen=True)
class HandEyeCovariance:
    """Joint covariance (12, 12) of (w, dt) of mount_from_cam, then (w, dt) of far_from_board.

    `freedom` (12,) are the degrees of freedom of each variance: the arm's noise was estimated from a
    few views, so intervals are Student's (Satterthwaite 1946). `parts` split the covariance
    by cause: corners, the arm's turns, its shifts, and what was known beforehand.
    """

    joint: Float[Array, "12 12"]
    freedom: Float[Array, "12"]
    parts: dict[str, Float[Array, "12 12"]]

    @property
    def mount_from_cam(self) -> Float[Array, "6 6"]:
        """Of the camera on its end of the arm."""
        return self.joint[:6, :6]

    @property
    def far_from_board(self) -> Float[Array, "6 6"]:
        """Of the board on the other end."""
        return self.joint[6:, 6:]

    @property
    def sigma(self) -> Float[Array, "12"]:
        """One standard deviation of each."""
        return np.sqrt(np.diag(self.joint))

    @property
    def half_width(self) -> Float[Array, "12"]:
        """Half of the 95 % interval of each."""
        from scipy.special import stdtrit

        return self.sigma * np.asarray(stdtrit(self.freedom, 0.975))

    @property
    def position_m(self) -> float:
        """Root mean square error of the camera's position, all three axes together [m]."""
        return float(np.sqrt(np.trace(self.joint[3:6, 3:6])))

    @property
    def turn(self) -> float:
        """The same of how it is turned [rad]."""
        return float(np.sqrt(np.trace(self.joint[:3, :3])))


def hand_eye_covariance(
    solved: Weighed, estimate: NoiseEstimate, setup: Setup, camera_count: int
) -> HandEyeCovariance:
    """From the reduced problem at the minimum; `camera_count` free camera parameters come first in it."""
    p = camera_count
    fixed, carried = list(range(p, p + 6)), list(range(p + 6, p + 12))
    order = np.array(carried + fixed if setup.carries_camera else fixed + carried)
    C, WH = solved.covariance, solved.weighed_design
    variances = estimate.noise.variances

    def cut(matrix: Array) -> Float[Array, "12 12"]:
        return matrix[np.ix_(order, order)]

    by_variance = []
    for part in (slice(0, 3), slice(3, 6)):
        by_variance.append(C @ np.einsum("vik,vil->kl", WH[:, part], WH[:, part]) @ C)
    pictures = C @ np.einsum("vik,vij,vjl->kl", WH, solved.of.by_pictures, WH) @ C
    known = C @ solved.of.prior @ C
    parts = {
        "corners": cut(pictures),
        "arm's turns": cut(variances[0] * by_variance[0]),
        "arm's shifts": cut(variances[1] * by_variance[1]),
        "what was known": cut(known),
    }
    slope = np.stack([np.diag(cut(matrix)) for matrix in by_variance], axis=1)
    spread = np.einsum("ik,kl,il->i", slope, np.linalg.pinv(estimate.information), slope)
    own = np.diag(cut(C))
    freedom = np.clip(2 * own**2 / np.maximum(spread, 1e-300), 1.0, 1e6)
    return HandEyeCovariance(cut(C), freedom, parts)
