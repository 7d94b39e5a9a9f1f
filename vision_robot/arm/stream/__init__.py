"""Joint commands on their way to the arm: as a table in a file, and frame by frame over a serial line."""

from vision_robot.arm.stream.frame import Frame, FrameReader
from vision_robot.arm.stream.joint_table import JointTable
from vision_robot.arm.stream.link import Link, Port
from vision_robot.arm.stream.messages import VERSION, Answer, Kind, Status, Welcome
from vision_robot.arm.stream.playback import play
from vision_robot.arm.stream.pose_table import PoseTable
from vision_robot.arm.stream.serial_port import SerialPort

__all__ = [
    "VERSION",
    "Answer",
    "Frame",
    "FrameReader",
    "JointTable",
    "Kind",
    "Link",
    "Port",
    "PoseTable",
    "SerialPort",
    "Status",
    "Welcome",
    "play",
]
