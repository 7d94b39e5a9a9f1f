"""What a calibration returns: never a bare rms."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.covariance import Covariance
from vision_robot.calibrate.settings import Settings
from vision_robot.calibrate.warp import Warp
from vision_robot.calibrate.weighting import UNDOUBTED, Trust
from vision_robot.geometry import SE3, Camera
from vision_robot.types import Array, Bool, Float

__all__ = ["CalibrationResult", "Rejected"]


@dataclass(frozen=True)
class Rejected:
    """A view or corner that was left out, and why."""

    image: str
    reason: str
    corner: int | None = None
    """Id of the corner; None for the whole view."""


@dataclass(frozen=True)
class CalibrationResult:
    """A calibrated camera with everything needed to judge it.

    `residuals` holds projected minus seen [px] of each view's corners, (n, 2) in the
    order of `corners`; `warp` how the board departs from its drawing; `trust`
    how far the detector's sigmas were believed.
    """

    camera: Camera
    cam_from_board: SE3
    warp: Warp
    corners: tuple[Corners, ...]
    residuals: tuple[Float[Array, "_ 2"], ...]
    covariance: Covariance
    settings: Settings
    trust: Trust = UNDOUBTED
    rejected: tuple[Rejected, ...] = ()
    iterations: int = 0

    @property
    def free(self) -> Bool[Array, "p"]:
        """Which of Camera.parameters were estimated."""
        return self.settings.free

    @property
    def rms_px(self) -> float:
        """Root mean square reprojection error per point, both axes together [px]."""
        return _rms(np.concatenate(self.residuals))

    @property
    def view_rms_px(self) -> Float[Array, "views"]:
        """The same for each view."""
        return np.array([_rms(residual) for residual in self.residuals])

    @property
    def corner_count(self) -> int:
        """How many corners were used."""
        return sum(map(len, self.corners))

    @property
    def degrees_of_freedom(self) -> int:
        """Measured numbers less estimated ones."""
        estimated = int(self.free.sum()) + len(self.warp) + 6 * len(self.corners)
        return 2 * self.corner_count + len(self.settings.priors) - estimated

    @property
    def noise_px(self) -> float:
        """Standard deviation of a corner per axis that the residuals tell [px]."""
        return float(np.sqrt(np.sum(np.concatenate(self.residuals) ** 2) / max(self.degrees_of_freedom, 1)))

    @property
    def sigma(self) -> dict[str, float]:
        """One standard deviation of each estimated and determined intrinsic parameter."""
        pairs = zip(self.camera.parameter_names, self.covariance.sigma, self.free, strict=True)
        lost = self.covariance.undetermined
        return {name: float(value) for name, value, is_free in pairs if is_free and name not in lost}


def _rms(residuals: Float[Array, "n 2"]) -> float:
    return float(np.sqrt(np.mean(np.sum(residuals**2, axis=1))))
