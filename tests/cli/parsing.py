"""Command lines held against the commands, without running anything."""

import typer
from typer.core import TyperGroup

from vision_robot_cli.main import app

__all__ = ["parse"]


def parse(words: list[str]) -> None:
    """Raise where `vr` would refuse these words."""
    name, command, context = "vr", typer.main.get_command(app), None
    while isinstance(command, TyperGroup) and words and not words[0].startswith("-"):
        context = command.make_context(name, [], parent=context, resilient_parsing=True)
        name, words = words[0], words[1:]
        command = command.get_command(context, name)
        assert command, f"there is no command {name}"
    # The options of `vr` itself end the program while they are parsed.
    if context is not None:
        command.make_context(name, words, parent=context)
