"""The coloured label on the hand (O12): where it has to be, and whether it is seen whole."""

from dataclasses import dataclass

import numpy as np

from vision_robot.arm import Arm, read_arm
from vision_robot.geometry import SE3
from vision_robot.pick.knowledge import Knowledge
from vision_robot.sim.cell_design import ArmMount
from vision_robot.sim.cell_model import LABEL
from vision_robot.track.blobs import Blobs
from vision_robot.types import Array, Float

__all__ = ["LABEL_SIGMA_PX", "HandLabel", "label_of", "seen_whole"]

LABEL_SIGMA_PX = 0.1
"""Standard deviation per axis of the centroid of a label that is seen whole."""

AREA = (0.8, 1.25)
"""Of its expected area: so far off a camera may be knocked before another thing is a better guess."""

STRETCHED = 0.06
"""Logarithm of how much more it may be stretched one way than another; a strip of 1 % cut off makes 0.02."""

FILLED = 0.02
"""How far its area may be from that of a parallelogram with the same second moments."""


@dataclass(frozen=True)
class HandLabel:
    """A label whose place on the hand is known from the arm's file."""

    tool_from_label: SE3
    size_m: tuple[float, float]

    def corners_in_station(self, knowledge: Knowledge, joints: Float[Array, "n"]) -> Float[Array, "4 3"]:
        """Its corners [m] where the controller believes them to be, by its joints alone."""
        width, height = self.size_m
        corners = 0.5 * np.array(
            [[-width, -height, 0], [width, -height, 0], [width, height, 0], [-width, height, 0]]
        )
        return self.station_from_label(knowledge, joints).apply(corners)

    def corners_px(self, knowledge: Knowledge, joints: Float[Array, "n"]) -> Float[Array, "4 2"]:
        """Their pixels, by what is believed."""
        plane = knowledge.plane
        return plane.camera.project(plane.cam_from_station.apply(self.corners_in_station(knowledge, joints)))

    def station_from_label(self, knowledge: Knowledge, joints: Float[Array, "n"]) -> SE3:
        """Where the controller believes the label is, by its joints alone."""
        return self.station_from_tool(knowledge, joints) @ self.tool_from_label

    def station_from_tool(self, knowledge: Knowledge, joints: Float[Array, "n"]) -> SE3:
        """Where the controller believes the tool is."""
        return knowledge.base_from_station.inverse() @ knowledge.arm.chain.base_from_tool(joints)


def label_of(arm: Arm, mount: ArmMount) -> HandLabel:
    """The label's place on the arm: the site "label" of its file."""
    labelled = read_arm(mount.mjcf or "column", tool=LABEL).chain.wrist_from_tool
    return HandLabel(arm.chain.wrist_from_tool.inverse() @ labelled, mount.label_m)


def seen_whole(blobs: Blobs, corners_px: Float[Array, "4 2"]) -> Float[Array, "2"] | None:
    """Centroid of the largest blob, if it is the whole of a label with these corners; else None.

    A label that something covers in part is stretched, or no parallelogram: what is compared are second
    moments, since areas alone change with a camera that was knocked.
    """
    if not len(blobs):
        return None
    best = int(np.argmax(blobs.area_px))
    sides = np.stack([corners_px[1] - corners_px[0], corners_px[3] - corners_px[0]], axis=1)
    area, axes = float(blobs.area_px[best]), blobs.axes_px[best]
    c, s = np.cos(blobs.yaw_rad[best]), np.sin(blobs.yaw_rad[best])
    turn = np.array([[c, -s], [s, c]]) if np.isfinite(c) else np.eye(2)
    # A parallelogram's second moments are its sides' dyads over 12, an ellipse's its axes squared over 16.
    stretch = np.linalg.svd(np.linalg.solve(sides / np.sqrt(12), turn @ np.diag(axes / 4)))[1]
    whole = (
        AREA[0] < area / abs(np.linalg.det(sides)) < AREA[1]
        and 2 * abs(np.log(stretch[0] / stretch[1])) < STRETCHED
        and abs(area / (0.75 * float(axes.prod())) - 1) < FILLED
    )
    return blobs.centroid_px[best] if whole else None
