"""Where one fixed camera saw a tool's tip."""

from dataclasses import dataclass

from vision_robot.geometry import SE3, KnownCamera
from vision_robot.types import Array, Float

__all__ = ["TipView"]


@dataclass(frozen=True)
class TipView:
    """The tip as one fixed camera saw it: `pixels` (poses, 2), NaN where it did not.

    `cam_from_base` is the camera's place where it is known (as from hand-eye calibration), with the
    covariance (6, 6) of (w [rad], dt [m]); else it is estimated.
    """

    name: str
    known: KnownCamera
    pixels: Float[Array, "poses 2"]
    sigma_px: float = 1.0
    cam_from_base: SE3 | None = None
    pose_covariance: Float[Array, "6 6"] | None = None
