"""The work plane seen by a calibrated camera: pixels to positions with their covariance, and back."""

from dataclasses import dataclass

import numpy as np

from vision_robot.geometry.camera import Camera
from vision_robot.geometry.known_camera import KnownCamera, checked_covariance
from vision_robot.geometry.plane import plane_from_pixels
from vision_robot.geometry.se3 import SE3, skew
from vision_robot.types import Array, Float

__all__ = ["POSE_NAMES", "WorkPlane"]

POSE_NAMES = ("wx", "wy", "wz", "tx", "ty", "tz")
"""The perturbation of a pose: R <- Exp(w) R [rad], t <- t + dt [m]."""


@dataclass(frozen=True)
class WorkPlane:
    """A camera, where the station {S} stands before it, and how well both are known together.

    The work plane is Z = 0 of {S}. `covariance` (p + 6, p + 6) follows `Camera.parameters`, then
    the perturbation (w [rad], dt [m]) of `cam_from_station`; zeros for what is taken as exact.
    The two parts must come from one estimate: a camera's error and the error of a pose found
    with that camera cancel to a large part, and only their cross terms know it.
    """

    camera: Camera
    cam_from_station: SE3
    covariance: Float[Array, "q q"]

    def __post_init__(self) -> None:
        size = len(self.parameter_names)
        object.__setattr__(self, "covariance", checked_covariance(self.covariance, size, "work plane"))

    @classmethod
    def exact(cls, camera: Camera, cam_from_station: SE3) -> "WorkPlane":
        """A plane taken as known: only the noise of pixels counts then."""
        size = len(camera.parameters) + 6
        return cls(camera, cam_from_station, np.zeros((size, size)))

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the rows of `covariance`."""
        return (*self.camera.parameter_names, *POSE_NAMES)

    @property
    def known_camera(self) -> KnownCamera:
        """The camera with its own part of the covariance."""
        p = len(self.camera.parameters)
        return KnownCamera(self.camera, self.covariance[:p, :p])

    @property
    def pose_covariance(self) -> Float[Array, "6 6"]:
        """Covariance of (w [rad], dt [m]) alone."""
        return self.covariance[-6:, -6:]

    def measure(
        self,
        pixels: Float[Array, "n 2"],
        sigma_px: float | Float[Array, "n"] = 0.0,
        *,
        z_m: float = 0.0,
        sigma_z_m: float = 0.0,
    ) -> tuple[Float[Array, "n 2"], Float[Array, "n 2 2"]]:
        """Positions (X, Y) [m] in {S} seen at pixels, and their covariance [m^2].

        `sigma_px` is the standard deviation of the pixels per axis. Points are taken to lie at the
        height `z_m` of {S}, known to `sigma_z_m`. NaN above the horizon and outside the lens' field.

        The position x solves ``project(R x + t; b) = pixel``, so that small errors obey
        ``J_x dx + J_b db + J_pose dpose + J_z dz = dpixel`` with the Jacobians of the projection.
        """
        positions, in_pixel, in_known, in_height = self._sensitivity(pixels, z_m)
        spread = np.broadcast_to(np.asarray(sigma_px, dtype=float), len(positions))[:, None, None]
        covariance = spread**2 * (in_pixel @ np.swapaxes(in_pixel, 1, 2))
        covariance = covariance + in_known @ self.covariance @ np.swapaxes(in_known, 1, 2)
        raised = sigma_z_m * in_height
        return positions, covariance + raised[:, :, None] * raised[:, None, :]

    def joint_covariance(
        self, pixels: Float[Array, "n 2"], sigma_px: float | Float[Array, "n"] = 0.0, *, z_m: float = 0.0
    ) -> Float[Array, "2*n 2*n"]:
        """Covariance [m^2] of all positions (X0, Y0, X1, Y1, ...) together.

        Points share the camera's and the plane's errors: a length between two of them is known better
        than their positions.
        """
        positions, in_pixel, in_known, _ = self._sensitivity(pixels, z_m)
        n = len(positions)
        rows = in_known.reshape(2 * n, -1)
        joint = rows @ self.covariance @ rows.T
        spread = np.broadcast_to(np.asarray(sigma_px, dtype=float), n)[:, None, None]
        own = spread**2 * (in_pixel @ np.swapaxes(in_pixel, 1, 2))
        for i in range(n):
            joint[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] += own[i]
        return joint

    def pixels(self, positions: Float[Array, "n 2"], *, z_m: float = 0.0) -> Float[Array, "n 2"]:
        """Pixels of positions (X, Y) [m] at the height `z_m`; NaN outside the lens' field."""
        return self.camera.project(self.cam_from_station.apply(_raised(positions, z_m)))

    def _sensitivity(
        self, pixels: Float[Array, "n 2"], z_m: float
    ) -> tuple[Float[Array, "n 2"], Float[Array, "n 2 2"], Float[Array, "n 2 q"], Float[Array, "n 2"]]:
        """Positions and their derivatives in the pixel, in camera and pose, and in the height."""
        pose = self.cam_from_station
        level = pose @ SE3(np.eye(3), np.array([0.0, 0.0, z_m]))
        positions = plane_from_pixels(self.camera, level, np.asarray(pixels, dtype=float))
        turned = _raised(positions, z_m) @ pose.rotation.T
        _, in_point, in_camera = self.camera.project_jacobian(turned + pose.translation)
        on_plane = in_point @ pose.rotation
        in_pixel = _inverse(on_plane[:, :, :2])
        in_pose = np.concatenate([-in_point @ skew(turned), in_point], axis=2)
        in_known = -in_pixel @ np.concatenate([in_camera, in_pose], axis=2)
        in_height = -(in_pixel @ on_plane[:, :, 2:])[:, :, 0]
        return positions, in_pixel, in_known, in_height


def _raised(positions: Float[Array, "n 2"], z_m: float) -> Float[Array, "n 3"]:
    positions = np.asarray(positions, dtype=float)
    return np.concatenate([positions, np.full((len(positions), 1), z_m)], axis=1)


def _inverse(matrices: Float[Array, "n 2 2"]) -> Float[Array, "n 2 2"]:
    """Inverses; NaN stays NaN, where numpy's own would raise for a singular one."""
    (a, b), (c, d) = matrices[:, 0].T, matrices[:, 1].T
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.array([[d, -b], [-c, a]]).transpose(2, 0, 1) / (a * d - b * c)[:, None, None]
