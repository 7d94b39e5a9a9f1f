"""An arm's kinematics as C for a microcontroller."""

from vision_robot.arm.export_c.cost import Cost
from vision_robot.arm.export_c.export import METHODS, TARGETS, Export, export_c
from vision_robot.arm.export_c.fingerprint import fingerprint
from vision_robot.arm.export_c.precision import PRECISIONS

__all__ = ["METHODS", "PRECISIONS", "TARGETS", "Cost", "Export", "export_c", "fingerprint"]
