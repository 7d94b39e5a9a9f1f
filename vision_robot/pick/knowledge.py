"""What a robot's controller believes about its cell."""

from collections.abc import Collection
from dataclasses import dataclass, field, replace

import numpy as np

from vision_robot.arm import Arm
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera, WorkPlane
from vision_robot.types import Array, Float

__all__ = ["STAGES", "Knowledge"]

STAGES = ("calibration", "tracking", "plane", "ik", "control")
"""Where millimetres are lost between an object and the gripper, in the order of the data's way.

calibration: the camera's intrinsics. tracking: where in the picture the object is. plane: where the
station stands before the camera and in the arm's base. ik: the arm's geometry. control: how well
the servos hold what they are told.
"""


@dataclass(frozen=True)
class Knowledge:
    """Camera and plane, station and arm: believed, or true.

    O1's chain uses all of it: pixel -> `plane` -> {S} -> `base_from_station` -> {B} -> `arm` -> joints.
    """

    plane: WorkPlane
    base_from_station: SE3
    arm: Arm
    station_covariance: Float[Array, "6 6"] = field(default_factory=lambda: np.zeros((6, 6)), compare=False)
    """Of base_from_station, a turn [rad] and a shift [m] in base axes."""
    joint_covariance: Float[Array, "n n"] | None = field(default=None, compare=False)
    """How well the arm's geometry is known, as errors of its joints [m, rad]; None: taken as drawn."""

    def corrected(self, truth: "Knowledge", stages: Collection[str]) -> "Knowledge":
        """The same with what `stages` mean replaced by the truth; tracking and control mean none of it."""
        unknown = set(stages) - set(STAGES)
        if unknown:
            raise BadParameter("stage", sorted(unknown), f"one of {', '.join(STAGES)}")
        camera: Camera = truth.plane.camera if "calibration" in stages else self.plane.camera
        moved = truth if "plane" in stages else self
        plane = self.plane
        if "calibration" in stages or "plane" in stages:
            plane = WorkPlane.exact(camera, moved.plane.cam_from_station)
        return replace(
            self,
            plane=plane,
            base_from_station=moved.base_from_station,
            arm=truth.arm if "ik" in stages else self.arm,
            station_covariance=moved.station_covariance,
            joint_covariance=truth.joint_covariance if "ik" in stages else self.joint_covariance,
        )
