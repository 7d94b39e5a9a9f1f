"""The commands of `vr`: name, the function that runs it, one line of help.

A command's file is imported when the command runs, so that `vr --help` answers at once. To add
one: write `<name>.py` beside this file with a function of plain Typer parameters, and a line here.
"""

from typing import NamedTuple

__all__ = ["COMMANDS", "Command"]


class Command(NamedTuple):
    """Where a command lives and what it is for."""

    target: str
    """module:function."""
    help: str


COMMANDS: dict[str, Command] = {
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
    "synth": Command(
        "vision_robot_cli.synth:synth",
        "Render a dataset with exact truth from a recipe: tracks, masks, flow, poses.",
    ),
}
