"""Several cameras fixed to each other."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry.camera import Camera
from vision_robot.geometry.known_camera import KnownCamera, checked_covariance
from vision_robot.geometry.se3 import SE3
from vision_robot.geometry.work_plane import POSE_NAMES
from vision_robot.types import Array, Float

__all__ = ["CameraRig"]


@dataclass(frozen=True)
class CameraRig:
    """Cameras by name, where each stands in the rig's frame, and how well all of it is known together.

    `covariance` (q, q) holds for each camera in turn its `Camera.parameters`, then the perturbation
    (w [rad], dt [m]) of its `cam_from_rig`; zeros for what is taken as exact. The rig's frame is usually the
    first camera's, whose pose then has none.
    """

    names: tuple[str, ...]
    cameras: tuple[Camera, ...]
    cam_from_rig: SE3
    covariance: Float[Array, "q q"]

    def __post_init__(self) -> None:
        counts = (len(self.names), len(self.cameras), len(self.cam_from_rig))
        if not counts[0] == counts[1] == counts[2] > 0:
            raise BadParameter(
                "rig: counts of names, cameras, poses", counts, "one or more, of each the same"
            )
        if len(set(self.names)) < len(self.names):
            raise BadParameter("rig: names", self.names, "different")
        size = sum(len(camera.parameters) + 6 for camera in self.cameras)
        object.__setattr__(self, "covariance", checked_covariance(self.covariance, size, "rig"))

    @classmethod
    def exact(cls, names: tuple[str, ...], cameras: tuple[Camera, ...], cam_from_rig: SE3) -> "CameraRig":
        """A rig taken as known."""
        size = sum(len(camera.parameters) + 6 for camera in cameras)
        return cls(names, cameras, cam_from_rig, np.zeros((size, size)))

    def __len__(self) -> int:
        return len(self.cameras)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the rows of `covariance`: ``left.fx``, ..., ``left.tz``, ``right.fx``, ..."""
        return tuple(
            f"{name}.{one}"
            for name, camera in zip(self.names, self.cameras, strict=True)
            for one in (*camera.parameter_names, *POSE_NAMES)
        )

    def rows(self, index: int) -> slice:
        """A camera's rows of `covariance`."""
        sizes = [len(camera.parameters) + 6 for camera in self.cameras]
        first = sum(sizes[:index])
        return slice(first, first + sizes[index])

    def known_camera(self, index: int) -> KnownCamera:
        """One of the cameras with its own part of the covariance."""
        rows = self.rows(index)
        own = slice(rows.start, rows.stop - 6)
        return KnownCamera(self.cameras[index], self.covariance[own, own])

    def pose_covariance(self, index: int) -> Float[Array, "6 6"]:
        """Covariance of one camera's (w [rad], dt [m])."""
        last = self.rows(index).stop
        return self.covariance[last - 6 : last, last - 6 : last]
