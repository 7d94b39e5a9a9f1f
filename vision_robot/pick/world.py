"""How the cell really is, faults included, and how it was calibrated."""

from dataclasses import dataclass, field

import numpy as np

from vision_robot.arm import Arm, read_arm
from vision_robot.geometry import SE3, Camera, WorkPlane
from vision_robot.pick.knowledge import Knowledge
from vision_robot.sim.cell_design import ArmMount, CellDesign, Item, Lights, StationCamera, look_at
from vision_robot.types import Array, Float

__all__ = ["ROD", "World", "ordinary_world"]

ROD = Item("rod", "rod", (0.12, 0.010), colour=(0.85, 0.14, 0.10))

CAMERA = Camera(
    640, 480, 702.4, 700.9, 322.6, 236.1, model="brown5", distortion=(-0.12, 0.06, 4e-4, -3e-4, 0.0)
)


@dataclass(frozen=True)
class World:
    """The truth of a cell.

    What stands here is never told to the controller; it knows only what `calibrated` gives it.
    """

    design: CellDesign
    view: StationCamera
    """The camera as it stood when it was calibrated."""
    arm: Arm
    """The arm as drawn; the real one differs by `joint_offset`."""
    knock: SE3 = field(default_factory=SE3.identity, compare=False)
    """after_from_before: how the camera was moved in its own frame after it was calibrated."""
    joint_offset: Float[Array, "n"] | None = field(default=None, compare=False)
    """Real joint values less those the encoders tell [m, rad]."""
    backlash: Float[Array, "n"] | None = field(default=None, compare=False)
    """Play of each joint [m, rad]: it stops this much short, on the side it comes from."""
    square_scale: float = 1.0
    """True size of the calibration board's squares over the size that was typed."""
    lens: str = "brown5"
    """Lens model that is fitted."""
    corner_noise_px: float = 0.05
    """Noise of the board's corners, per axis, when the cell was calibrated."""
    touch_noise_m: float = 2e-4
    """Noise per axis with which the arm touches the marks that tell where the station is."""
    image_noise: float = 2.0
    """Noise of the pictures [levels]."""
    frame_rate: float = 30.0
    latency_s: float = 0.0
    """From a picture's moment to its blobs: for closed loops, and for what moves."""
    place: tuple[float, float, float] = (0.02, -0.17, np.pi / 2)
    """Where things are put: x, y [m] and yaw [rad] in {S}."""
    lost_sight: float = 0.0
    """Share of pictures in which the hand's label is not seen, for closed loops."""

    @property
    def view_now(self) -> StationCamera:
        """The camera where it stands now."""
        return StationCamera(self.view.camera, self.knock @ self.view.cam_from_station, self.view.name)

    @property
    def truth(self) -> Knowledge:
        """What a controller without any error would know."""
        view = self.view_now
        plane = WorkPlane.exact(view.camera, view.cam_from_station)
        return Knowledge(plane, self.design.base_from_station, self.arm)

    def real_joints(self, told: Float[Array, "*m n"]) -> Float[Array, "*m n"]:
        """What the joints really are where the encoders say `told`."""
        return told if self.joint_offset is None else told + self.joint_offset

    def told_joints(self, real: Float[Array, "*m n"]) -> Float[Array, "*m n"]:
        """What the encoders say where the joints really are `real`."""
        return real if self.joint_offset is None else real - self.joint_offset


def ordinary_world(*items: Item, camera: Camera = CAMERA, shadows: bool = True) -> World:
    """One rod (or `items`) on the table, the column arm, and a camera that looks down from 0.75 m."""
    design = CellDesign(
        items=items or (ROD,),
        arm=ArmMount(),
        lights=Lights(shadows=shadows),
        scatter_m=(-0.10, -0.13, 0.08, 0.13),
    )
    view = look_at(camera, (-0.14, 0.0, 0.74), (0.0, 0.0, 0.0))
    return World(design, view, read_arm("column"))


def no_offset(arm: Arm) -> Float[Array, "n"]:
    """Zero for each joint."""
    return np.zeros(len(arm))
