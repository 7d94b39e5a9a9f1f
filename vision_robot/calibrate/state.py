"""The unknowns of a calibration and how a step moves them."""

from dataclasses import dataclass, replace

import numpy as np

from vision_robot.calibrate.warp import Warp
from vision_robot.geometry import SE3, Camera, rotation_exp
from vision_robot.types import Array, Bool, Float

__all__ = ["State"]


@dataclass(frozen=True)
class State:
    """A camera, the board's warp, and the pose of the board in each view.

    The *shared* parameters are the camera's followed by the warp's coefficients.
    """

    camera: Camera
    cam_from_board: SE3
    warp: Warp

    @property
    def shared_names(self) -> tuple[str, ...]:
        """Names of the shared parameters."""
        return (*self.camera.parameter_names, *self.warp.names)

    @property
    def shared_parameters(self) -> Float[Array, "s"]:
        """Values of the shared parameters."""
        return np.concatenate([self.camera.parameters, self.warp.coefficients])

    def moved(
        self, free: Bool[Array, "p"], shared_step: Float[Array, "f"], pose_step: Float[Array, "views 6"]
    ) -> "State | None":
        """The state after a step of the `free` shared parameters and (w, dt); None if it is no camera."""
        p = len(self.camera.parameters)
        shared = self.shared_parameters
        shared[free] += shared_step
        if not np.all(np.isfinite(shared)) or shared[0] <= 0 or shared[1] <= 0:
            return None
        rotation = rotation_exp(pose_step[:, :3]) @ self.cam_from_board.rotation
        translation = self.cam_from_board.translation + pose_step[:, 3:]
        return State(
            self.camera.with_parameters(shared[:p]),
            SE3(rotation, translation),
            replace(self.warp, coefficients=shared[p:]),
        )
