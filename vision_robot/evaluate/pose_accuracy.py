"""Accuracy and repeatability of a robot's poses, as ISO 9283:1998 defines them."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3
from vision_robot.types import Array, Float

__all__ = ["PoseAccuracy", "pose_accuracy"]


@dataclass(frozen=True)
class PoseAccuracy:
    """How n attained poses lie about one commanded pose; all in [0, inf), best 0.

    Accuracy is a bias, repeatability a spread: a robot may have one without the other.
    """

    accuracy_m: float
    """AP: distance of the attained positions' barycentre from the commanded position (7.2.1)."""
    repeatability_m: float
    """RP: radius ``mean(l) + 3 std(l)`` about the barycentre, l the distances from it (7.2.2)."""
    yaw_accuracy_rad: float
    """AP_c: mean turn about the commanded z axis, its absolute value."""
    yaw_repeatability_rad: float
    """RP_c: three standard deviations of that turn."""
    n: int


def pose_accuracy(commanded: SE3, attained: SE3) -> PoseAccuracy:
    """Figures of one commanded pose from `attained` (n,), both in one frame.

    The standard asks for 30 repetitions; fewer than two leave no spread and are refused (BadParameter).
    """
    n = len(attained)
    if commanded.batch or n < 2:
        raise BadParameter("attained poses", n, "two or more, of one commanded pose")
    offset = attained.translation - commanded.translation
    barycentre = offset.mean(axis=0)
    spread = np.linalg.norm(offset - barycentre, axis=1)
    turn = (commanded.inverse() @ attained).rotvec()[:, 2]
    return PoseAccuracy(
        accuracy_m=float(np.linalg.norm(barycentre)),
        repeatability_m=float(spread.mean() + 3 * spread.std(ddof=1)),
        yaw_accuracy_rad=abs(_circular_mean(turn)),
        yaw_repeatability_rad=3 * float(_around(turn).std(ddof=1)),
        n=n,
    )


def _circular_mean(angle: Float[Array, "n"]) -> float:
    return float(np.angle(np.exp(1j * angle).mean()))


def _around(angle: Float[Array, "n"]) -> Float[Array, "n"]:
    """Angles as differences from their mean, so that half a turn is no jump."""
    return np.angle(np.exp(1j * (angle - _circular_mean(angle))))
