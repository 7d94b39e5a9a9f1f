"""A camera together with how well it is known."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry.camera import Camera
from vision_robot.types import Array, Float

__all__ = ["KnownCamera", "checked_covariance"]


@dataclass(frozen=True)
class KnownCamera:
    """A camera and the covariance (p, p) of `Camera.parameters`; zeros for what is taken as exact."""

    camera: Camera
    covariance: Float[Array, "p p"]

    def __post_init__(self) -> None:
        size = len(self.camera.parameters)
        object.__setattr__(self, "covariance", checked_covariance(self.covariance, size, "camera"))

    @classmethod
    def exact(cls, camera: Camera) -> "KnownCamera":
        """A camera of whose error nothing is known, or none is wanted."""
        size = len(camera.parameters)
        return cls(camera, np.zeros((size, size)))

    @property
    def taken_as_exact(self) -> bool:
        """Whether no parameter has any uncertainty."""
        return not self.covariance.any()

    @property
    def sigma(self) -> dict[str, float]:
        """One standard deviation of each parameter that has one."""
        sigma = np.sqrt(np.diag(self.covariance))
        named = zip(self.camera.parameter_names, sigma, strict=True)
        return {name: float(value) for name, value in named if value > 0}


def checked_covariance(matrix: Float[Array, "_ _"], size: int, what: str) -> Float[Array, "size size"]:
    """The matrix, exactly symmetric; raises BadParameter where it is no covariance of `size` numbers."""
    matrix = np.asarray(matrix, dtype=float)
    if matrix.shape != (size, size):
        raise BadParameter(f"covariance of the {what}", matrix.shape, f"{size} x {size} numbers")
    if not np.isfinite(matrix).all():
        raise BadParameter(f"covariance of the {what}", "not a number", "finite numbers")
    sigma = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    # Entries differ by ten orders of magnitude: both questions are asked of the correlations.
    scale = np.where(sigma > 0, sigma, 1.0)
    correlation = matrix / scale[:, None] / scale
    if np.abs(correlation - correlation.T).max(initial=0) > 1e-6:
        raise BadParameter(f"covariance of the {what}", "not symmetric", "symmetric")
    symmetric = (correlation + correlation.T) / 2
    if np.diag(matrix).min(initial=0) < 0 or np.linalg.eigvalsh(symmetric).min(initial=0) < -1e-6:
        raise BadParameter(f"covariance of the {what}", "negative in some direction", "positive or zero")
    return symmetric * scale[:, None] * scale
