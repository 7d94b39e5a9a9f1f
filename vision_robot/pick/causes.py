"""Why episodes end short of success, in words that can be counted."""

from vision_robot.errors import (
    BadPath,
    GripperTooNarrow,
    InTheWay,
    LostSight,
    NothingSeen,
    ServoAstray,
    TooLate,
    Unreachable,
    VisionRobotError,
)
from vision_robot.pick.episode import Episode

__all__ = ["ENDINGS", "cause_of", "ending_of"]

CAUSES: dict[type[VisionRobotError], str] = {
    NothingSeen: "out of sight",
    Unreachable: "out of reach",
    BadPath: "out of reach",
    GripperTooNarrow: "gripper too narrow",
    InTheWay: "in the way",
    TooLate: "gone by",
    LostSight: "label out of sight",
    ServoAstray: "servo astray",
}
"""What is raised on the way -> its cause."""

MISSED = {"seen": "missed", "reached": "not gripped", "gripped": "dropped", "lifted": "misplaced"}
"""Last rung that was reached -> what went wrong then."""

ENDINGS = (*dict.fromkeys(CAUSES.values()), *MISSED.values())
"""All words that `ending_of` can give."""

EXPECTED = tuple(CAUSES)
"""Errors that end an episode; others end the program."""


def cause_of(error: VisionRobotError) -> str:
    """The cause in a word or two."""
    return next(word for kind, word in CAUSES.items() if isinstance(error, kind))


def ending_of(episode: Episode) -> str:
    """Why the thing does not lie where it should; empty where it does."""
    if episode.placed:
        return ""
    return episode.cause or MISSED.get(episode.rung, "out of sight")
