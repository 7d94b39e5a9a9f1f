"""What of a goal pose an arm has to meet.

A goal is always a whole pose of the tool; a task says how much of it counts. Which task an arm
can meet everywhere follows from its joints. With six or more, a pose. With five, no pose drawn at random:
it has six numbers. The column arm's tool axis always lies in the upright plane of its last link, and
where that plane stands follows from the position; so it reaches any position with any `TILT`, and any
POSE or AXIS whose tool axis lies in that plane, to which a tool pointing straight down always belongs:
picking from a table, at every yaw, is a POSE for it.
"""

from enum import Enum

__all__ = ["Task"]


class Task(Enum):
    """Which part of the goal pose counts."""

    POSE = "pose"
    """Position and the whole orientation: six numbers."""
    AXIS = "axis"
    """Position and the direction of the tool's z axis: five; the tool may turn about it."""
    TILT = "tilt"
    """Position and how the tool stands to the base's z axis, its pitch and its roll: five numbers.

    The tool may turn about the base's z; where it points there is left to the arm.
    """
    POSITION = "position"
    """Position alone: three numbers."""
