"""Points on the work plane, none of which may be missing, and lengths between them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.errors import OffPlane
from vision_robot.geometry import WorkPlane
from vision_robot.types import Array, Float

__all__ = ["Measured", "measure_points"]


@dataclass(frozen=True)
class Measured:
    """Positions on the plane with their covariance, and (length, sigma) from each point to the next [m]."""

    positions_m: Float[Array, "n 2"]
    covariance_m2: Float[Array, "n 2 2"]
    lengths_m: tuple[tuple[float, float], ...]

    @property
    def sigma_m(self) -> Float[Array, "n 2"]:
        """One standard deviation in x and y."""
        return np.sqrt(np.diagonal(self.covariance_m2, axis1=1, axis2=2))


def measure_points(
    plane: WorkPlane,
    pixels: Float[Array, "n 2"],
    sigma_px: Float[Array, "n"],
    *,
    names: Sequence[str] = (),
    z_m: float = 0.0,
    sigma_z_m: float = 0.0,
) -> Measured:
    """As `WorkPlane.measure`, with lengths; raises OffPlane, naming the first pixel that sees no plane."""
    _check(plane, pixels, names, z_m)
    positions, covariance = plane.measure(pixels, sigma_px, z_m=z_m, sigma_z_m=sigma_z_m)
    lengths = []
    for i in range(len(pixels) - 1):
        pair = slice(i, i + 2)
        joint = plane.joint_covariance(pixels[pair], sigma_px[pair], z_m=z_m)
        step = positions[i + 1] - positions[i]
        length = float(np.linalg.norm(step))
        along = np.concatenate([-step, step]) / max(length, 1e-300)
        lengths.append((length, float(np.sqrt(max(along @ joint @ along, 0.0)))))
    return Measured(positions, covariance, tuple(lengths))


def _check(plane: WorkPlane, pixels: Float[Array, "n 2"], names: Sequence[str], z_m: float) -> None:
    camera = plane.camera
    inside = (pixels >= -0.5) & (pixels <= [camera.width - 0.5, camera.height - 0.5])
    seen = np.isfinite(camera.unproject(pixels)[:, 0])
    met = np.isfinite(plane.measure(pixels, z_m=z_m)[0][:, 0])
    for i in np.flatnonzero(~(inside.all(axis=1) & seen & met)).tolist():
        name = names[i] if len(names) else f"point {i + 1}"
        why = "it lies above the horizon"
        if not inside[i].all():
            why = f"it lies outside the picture of {camera.width}x{camera.height} px"
        elif not seen[i]:
            why = "the lens model sees nothing there"
        raise OffPlane(name, (float(pixels[i, 0]), float(pixels[i, 1])), why)
