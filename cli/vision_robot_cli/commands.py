"""The commands of `vr`: name, the function that runs it, one line of help.

A command's file is imported when the command runs, so that `vr --help` answers at once. To add
one: write `<name>.py` beside this file with a function of plain Typer parameters, and a line here.
Commands of one family share a first word, `vr extrinsics hand-eye`: a `Group` holds them.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

__all__ = ["COMMANDS", "Command", "Group", "every_command"]


class Command(NamedTuple):
    """Where a command lives and what it is for."""

    target: str
    """module:function."""
    help: str


class Group(NamedTuple):
    """Commands that share their first word."""

    commands: Mapping[str, Command]
    help: str


EXTRINSICS: dict[str, Command] = {
    "hand-eye": Command(
        "vision_robot_cli.hand_eye:hand_eye",
        "Where the camera sits on the arm, or beside it, from photos of a board and the arm's poses.",
    ),
}

TRACK: dict[str, Command] = {
    "video": Command(
        "vision_robot_cli.track:video",
        "Objects in a video: tracks as a table, an overlay, a report.",
    ),
    "camera": Command(
        "vision_robot_cli.track:camera",
        "The same before a camera, until Ctrl-C.",
    ),
    "pick": Command(
        "vision_robot_cli.track_pick:pick",
        "Choose a colour to track, and see its mask.",
    ),
}

COMMANDS: dict[str, Command | Group] = {
    "board": Command(
        "vision_robot_cli.board:board",
        "Write a printable calibration target to scale: PDF, SVG or PNG.",
    ),
    "calibrate": Command(
        "vision_robot_cli.calibrate:calibrate",
        "Calibrate a camera from photos, a video, corner files or, with nothing given, a rendered set.",
    ),
    "demo": Command(
        "vision_robot_cli.demo:demo",
        "The main job in one go: render a board, calibrate, show the camera beside the truth.",
    ),
    "doctor": Command(
        "vision_robot_cli.doctor:doctor",
        "What works on this machine: versions, OpenGL, video, GPU, compiler; and how to mend the rest.",
    ),
    "extrinsics": Group(
        EXTRINSICS,
        "Where the camera is: on an arm, over a table, beside other cameras.",
    ),
    "track": Group(
        TRACK,
        "Where objects are, how they lie, how fast they move; in pixels and millimetres.",
    ),
}


def every_command() -> Iterator[tuple[tuple[str, ...], Command]]:
    """All commands with the words that call them, those of groups included."""
    for name, found in COMMANDS.items():
        if isinstance(found, Group):
            yield from (((name, inner), command) for inner, command in found.commands.items())
        else:
            yield (name,), found
