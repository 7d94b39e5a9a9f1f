"""What works on this machine, found by trying it; nothing in the library depends on this room."""

from vision_robot.machine.check import Check, Status
from vision_robot.machine.examine import examine

__all__ = ["Check", "Status", "examine"]
