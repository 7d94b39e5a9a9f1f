"""The pivot method: the tip held at one point while the wrist turns about it."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter, TooLittleMotion
from vision_robot.extrinsics.tool_checks import axis_in_words, turning_axis
from vision_robot.geometry import SE3
from vision_robot.types import Array, Float

__all__ = ["PivotFit", "fit_pivot"]

FEWEST = 4
CUTOFF = 5.0
STEEPEST_LOSS = 1e-4
"""Smallest turn [rad rms] that tells a direction at all: about 0.006 degrees."""


@dataclass(frozen=True)
class PivotFit:
    """The tip in the wrist's frame, the touched point and `residuals` in the base's [m]."""

    tip: Float[Array, "3"]
    covariance: Float[Array, "3 3"]
    point_in_base: Float[Array, "3"]
    residuals: Float[Array, "poses 3"]
    noise_m: float
    """Standard deviation of a touch per axis: the robot's own noise and the person's."""
    worst: tuple[int, ...]
    """Poses whose touch lies farther off than the others explain; none is left out."""

    @property
    def sigma(self) -> Float[Array, "3"]:
        """One standard deviation along the wrist's axes [m]."""
        return np.sqrt(np.diag(self.covariance))


def fit_pivot(base_from_wrist: SE3) -> PivotFit:
    """Solve ``R_i p + t_i = c`` for all poses: linear least squares in p and c.

    Raises BadParameter for fewer than four poses and TooLittleMotion naming the direction they leave unknown.
    """
    n = len(base_from_wrist)
    if n < FEWEST:
        raise BadParameter("poses that touch the point", n, f"at least {FEWEST}")
    R, t = base_from_wrist.rotation, base_from_wrist.translation
    A = np.concatenate([R, np.broadcast_to(-np.eye(3), (n, 3, 3))], axis=2).reshape(3 * n, 6)
    # With c eliminated what is left of p is its part that turns.
    turning = (R - R.mean(axis=0)).reshape(3 * n, 3)
    _, size, directions = np.linalg.svd(turning)
    if size[2] < STEEPEST_LOSS * np.sqrt(n):
        axis, spread, _ = turning_axis(base_from_wrist)
        unknown = f"the tip along the wrist's {axis_in_words(directions[2])}"
        why = f"the wrist turns by {np.degrees(spread):.0f} degrees about its {axis_in_words(axis)} only"
        raise TooLittleMotion(unknown, why, "tilt it by 15 degrees or more in other directions as well")
    solution, *_ = np.linalg.lstsq(A, -t.reshape(-1), rcond=None)
    residuals = (A @ solution + t.reshape(-1)).reshape(n, 3)
    variance = float(np.sum(residuals**2)) / (3 * n - 6)
    covariance = variance * np.linalg.inv(A.T @ A)
    length = np.linalg.norm(residuals, axis=1)
    far = length > CUTOFF * max(float(np.median(length)), 1e-12)
    return PivotFit(
        tip=solution[:3],
        covariance=covariance[:3, :3],
        point_in_base=solution[3:],
        residuals=residuals,
        noise_m=float(np.sqrt(variance)),
        worst=tuple(np.flatnonzero(far).tolist()),
    )
