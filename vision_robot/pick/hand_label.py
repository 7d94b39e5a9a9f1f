"""The coloured label on the hand (O12): where the camera sees the tool."""

from dataclasses import dataclass

import numpy as np

from vision_robot.arm import Arm, read_arm
from vision_robot.errors import NothingSeen
from vision_robot.geometry import SE3
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.sighting import PIXEL_SIGMA
from vision_robot.sim.cell_design import ArmMount
from vision_robot.sim.cell_model import LABEL
from vision_robot.track.blobs import Blobs
from vision_robot.types import Array, Float

__all__ = ["HandLabel", "SeenTool", "label_of"]


@dataclass(frozen=True)
class SeenTool:
    """Where the tool is in {S} by the label's pixel, with the covariance that the pixel's noise gives."""

    position_m: Float[Array, "2"]
    covariance_m2: Float[Array, "2 2"]


@dataclass(frozen=True)
class HandLabel:
    """A label whose place on the hand is known from the arm's file."""

    tool_from_label: SE3
    size_m: tuple[float, float]

    def expected_area_px(self, knowledge: Knowledge, joints: Float[Array, "n"]) -> float:
        """Area of its image where the controller believes it to be, seen whole."""
        plane, corners = knowledge.plane, self.corners_in_station(knowledge, joints)
        u, v = plane.camera.project(plane.cam_from_station.apply(corners)).T
        return float(abs(u @ np.roll(v, -1) - v @ np.roll(u, -1)) / 2)

    def corners_in_station(self, knowledge: Knowledge, joints: Float[Array, "n"]) -> Float[Array, "4 3"]:
        """Its corners [m] where the controller believes them to be, by its joints alone."""
        width, height = self.size_m
        corners = 0.5 * np.array(
            [[-width, -height, 0], [width, -height, 0], [width, height, 0], [-width, height, 0]]
        )
        return self.station_from_label(knowledge, joints).apply(corners)

    def station_from_label(self, knowledge: Knowledge, joints: Float[Array, "n"]) -> SE3:
        """Where the controller believes the label is, by its joints alone."""
        base_from_label = knowledge.arm.chain.base_from_tool(joints) @ self.tool_from_label
        return knowledge.base_from_station.inverse() @ base_from_label

    def seen_tool(
        self, knowledge: Knowledge, joints: Float[Array, "n"], pixel: Float[Array, "2"]
    ) -> SeenTool:
        """The tool's position by the picture; its height and its turn are taken from the joints."""
        label = self.station_from_label(knowledge, joints)
        tool = label @ self.tool_from_label.inverse()
        offset = tool.translation[:2] - label.translation[:2]
        positions, covariance = knowledge.plane.measure(
            pixel[None], PIXEL_SIGMA, z_m=float(label.translation[2])
        )
        return SeenTool(positions[0] + offset, covariance[0])

    def wanted_px(
        self, knowledge: Knowledge, joints: Float[Array, "n"], tool_position_m: Float[Array, "2"]
    ) -> Float[Array, "2"]:
        """Where the label has to be in the picture for the tool to be at that place, by what is believed."""
        label = self.station_from_label(knowledge, joints)
        tool = label @ self.tool_from_label.inverse()
        moved = label.translation[:2] + tool_position_m - tool.translation[:2]
        return knowledge.plane.pixels(moved[None], z_m=float(label.translation[2]))[0]


def label_of(arm: Arm, mount: ArmMount) -> HandLabel:
    """The label's place on the arm: the site "label" of its file."""
    labelled = read_arm(mount.mjcf or "column", tool=LABEL).chain.wrist_from_tool
    return HandLabel(arm.chain.wrist_from_tool.inverse() @ labelled, mount.label_m)


def largest(blobs: Blobs, tracker: str) -> tuple[Float[Array, "2"], float]:
    """Centroid and area of the largest blob; raises NothingSeen where there is none."""
    if not len(blobs):
        raise NothingSeen(tracker, "the label on the hand")
    best = int(np.argmax(blobs.area_px))
    return blobs.centroid_px[best], float(blobs.area_px[best])
