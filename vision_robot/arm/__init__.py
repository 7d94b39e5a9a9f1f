"""The arm: its model from MJCF or URDF, forward and inverse kinematics."""

from vision_robot.arm.frames import base_from_tool, base_from_wrist
from vision_robot.arm.model import ARMS, Arm, read_arm
from vision_robot.arm.task import Task

__all__ = ["ARMS", "Arm", "Task", "base_from_tool", "base_from_wrist", "read_arm"]
