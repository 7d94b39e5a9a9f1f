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
    "plane": Command(
        "vision_robot_cli.plane:plane",
        "Where the table is before the camera, from photos of a board lying on it, or marked points.",
    ),
    "rig": Command(
        "vision_robot_cli.rig:rig",
        "Where several cameras are to each other, from a board that two of them see at a time.",
    ),
    "tool": Command(
        "vision_robot_cli.tool:tool",
        "Where the tool's tip is on the wrist, from pictures by fixed cameras or from one point touched.",
    ),
}

IK: dict[str, Command] = {
    "solve": Command(
        "vision_robot_cli.ik_solve:ik_solve",
        "Joint values for poses of the tool, from a file or options; or why none reach them.",
    ),
    "check": Command(
        "vision_robot_cli.ik_check:ik_check",
        "An arm's model: its kind, whether its kinematics hold together, a map of where it reaches.",
    ),
    "export": Command(
        "vision_robot_cli.ik_export:ik_export",
        "C for a microcontroller: forward and inverse kinematics, and the receiver of joint commands.",
    ),
    "stream": Command(
        "vision_robot_cli.ik_stream:ik_stream",
        "Send a table of joint values, or poses to be solved there, to a microcontroller.",
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
    "demo": Command(
        "vision_robot_cli.demo:demo",
        "The main job in one go: render a board, calibrate, show the camera beside the truth.",
    ),
    "doctor": Command(
        "vision_robot_cli.doctor:doctor",
        "What works on this machine: versions, OpenGL, video, GPU, compiler; and how to mend the rest.",
    ),
    "board": Command(
        "vision_robot_cli.board:board",
        "Write a printable calibration target to scale: PDF, SVG or PNG.",
    ),
    "calibrate": Command(
        "vision_robot_cli.calibrate:calibrate",
        "Calibrate a camera from photos, a video, corner files or, with nothing given, a rendered set.",
    ),
    "extrinsics": Group(
        EXTRINSICS,
        "Where the camera is: on an arm, over a table, beside other cameras.",
    ),
    "undistort": Command(
        "vision_robot_cli.undistort:undistort",
        "Pictures or a video without lens distortion, and the camera they then have.",
    ),
    "measure": Command(
        "vision_robot_cli.measure:measure",
        "Pixels to millimetres on the work plane, each with its sigma.",
    ),
    "convert": Command(
        "vision_robot_cli.convert:convert",
        "A camera or rig file into any other tool's format.",
    ),
    "synth": Command(
        "vision_robot_cli.synth:synth",
        "Render a dataset with exact truth from a recipe: tracks, masks, flow, poses.",
    ),
    "track": Group(
        TRACK,
        "Where objects are, how they lie, how fast they move; in pixels and millimetres.",
    ),
    "ik": Group(
        IK,
        "An arm in an MJCF or URDF file: from poses to joints, and C for its microcontroller.",
    ),
    "pick": Command(
        "vision_robot_cli.pick:pick",
        "Pick and place in MuJoCo's physics, open or closed loop, with a score and an error budget.",
    ),
    "schema": Command(
        "vision_robot_cli.schema:schema",
        "The JSON Schema of a command's --json, or of a file that this tool writes.",
    ),
    "benchmark": Command(
        "vision_robot_cli.benchmark:benchmark",
        "Scenes x methods x seeds -> scores with confidence intervals, ours beside the peers.",
    ),
}


def every_command() -> Iterator[tuple[tuple[str, ...], Command]]:
    """All commands with the words that call them, those of groups included."""
    for name, found in COMMANDS.items():
        if isinstance(found, Group):
            yield from (((name, inner), command) for inner, command in found.commands.items())
        else:
            yield (name,), found
