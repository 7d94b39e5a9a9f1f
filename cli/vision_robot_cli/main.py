"""The `vr` command: finds the command asked for, runs it, turns every ending into an exit code.

0 done; 1 failed while running; 2 wrong usage or bad input; 3 a limit the user gave was missed;
130 interrupted. An error is one line on stderr; `--debug`, anywhere, gives the traceback instead.
"""

import importlib
import os
import sys
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, ClassVar

import typer
from typer.core import TyperGroup

from vision_robot_cli.commands import COMMANDS, Command, Group
from vision_robot_cli.examples import with_examples_whole
from vision_robot_cli.output import LimitMissed

__all__ = ["app", "main", "run"]

DEBUG = "--debug"
DEBUG_HELP = f"{DEBUG}, with any command: show the traceback of an error."


class LazyGroup(TyperGroup):
    """Commands from a registry, each imported when it is run."""

    registry: ClassVar[Mapping[str, Command | Group]] = COMMANDS

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ARG002 - click's signature
        """Names, in the registry's order."""
        return list(self.registry)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:  # noqa: ARG002
        """The command, built from its function; None where there is no such name."""
        found = self.registry.get(cmd_name)
        if isinstance(found, Group):
            return group_of(cmd_name, found)
        return command_of(cmd_name, load(found.target)) if found else None

    def format_commands(self, ctx: Any, formatter: Any) -> None:  # noqa: ARG002
        """The list in `vr --help`, without importing any command."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, command.help) for name, command in self.registry.items()])


def load(target: str) -> Callable[..., Any]:
    """The function that "module:function" names."""
    module, function = target.split(":")
    return getattr(importlib.import_module(module), function)


def command_of(name: str, function: Callable[..., Any]) -> Any:
    """A function of Typer parameters as a command called `name`."""
    single = typer.Typer(add_completion=False, rich_markup_mode=None)
    single.command(name, help=with_examples_whole(function.__doc__ or ""), epilog=DEBUG_HELP)(function)
    return typer.main.get_command(single)


def group_of(name: str, group: Group) -> Any:
    """The commands of a group under their common first word; the word alone shows what there is."""

    def alone(context: typer.Context) -> None:
        if context.invoked_subcommand is None:
            print(context.get_help())
            raise typer.Exit

    family = typer.Typer(
        name=name,
        cls=type(f"LazyGroup_{name}", (LazyGroup,), {"registry": group.commands}),
        add_completion=False,
        rich_markup_mode=None,
        invoke_without_command=True,
        help=group.help,
        epilog=DEBUG_HELP,
    )
    family.callback()(alone)
    return typer.main.get_command(family)


app = typer.Typer(
    cls=LazyGroup,
    rich_markup_mode=None,
    invoke_without_command=True,
    epilog=DEBUG_HELP,
)


@app.callback()
def root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False,
) -> None:
    """Vision Robot: from camera to grasp, with numbers for how good every step is.

    `vr COMMAND --help` explains a command with an example.
    """
    if version:
        import vision_robot

        print(f"vr {vision_robot.__version__}")
    elif context.invoked_subcommand is None:
        print(context.get_help())
    else:
        return
    raise typer.Exit


def main() -> None:
    """Entry point of the `vr` script."""
    if DEBUG not in sys.argv:
        speak_alone()
    sys.exit(run(sys.argv[1:]))


def speak_alone() -> None:
    """Leave stderr to us: libraries below print of damaged pictures what our one line says better."""
    warnings.simplefilter("ignore")
    for stream, number in ((sys.stdout, 1), (sys.stderr, 2)):
        if stream is None:  # closed by the caller; what is opened next would take its number
            os.dup2(os.open(os.devnull, os.O_RDWR), number)
    sys.stdout = sys.stdout or open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115, PTH123
    if sys.stderr is not None:
        ours = os.dup(2)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        sys.stderr = open(ours, "w", encoding=sys.stderr.encoding, errors="backslashreplace", buffering=1)  # noqa: SIM115, PTH123
    else:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115, PTH123
    # Names of files need not be text.
    sys.stdout.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]


def run(arguments: Sequence[str]) -> int:
    """Run `vr` with these arguments and return its exit code; raises only under `--debug`."""
    words, debug = without_debug(arguments)
    try:
        ended = typer.main.get_command(app).main(args=words, prog_name="vr", standalone_mode=False)
        sys.stdout.flush()
    except BrokenPipeError:
        # Whoever read our output has enough of it.
        leave_stdout()
        return 1
    except (KeyboardInterrupt, typer.Abort):
        ended = 130
    except Exception as error:
        if debug:
            raise
        code, line = verdict(error)
        print(f"vr: {' '.join(line.split())}", file=sys.stderr)
        leave_stdout()
        return code
    if ended == 130:  # Typer's own answer to an interrupt inside a command
        print("vr: interrupted", file=sys.stderr)
    return ended if isinstance(ended, int) else 0


def leave_stdout() -> None:
    """Bring out what was printed; where nobody takes it, let it go: Python would complain at its end."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def without_debug(arguments: Sequence[str]) -> tuple[list[str], bool]:
    """The arguments without `--debug`, and whether it was there; what follows `--` is left alone."""
    words = list(arguments)
    end = words.index("--") if "--" in words else len(words)
    kept = [word for word in words[:end] if word != DEBUG]
    return kept + words[end:], len(kept) < end


def verdict(error: Exception) -> tuple[int, str]:
    """Exit code and line for an error."""
    from vision_robot.errors import BadInput, VisionRobotError

    if isinstance(error, typer.TyperException):
        context = getattr(error, "ctx", None)
        help_of = f" (see '{context.command_path} --help')" if context else ""
        return 2, f"error: {error.format_message()}{help_of}"
    if isinstance(error, LimitMissed):
        return 3, str(error)
    if isinstance(error, BadInput):
        return 2, f"error: {error}"
    if isinstance(error, VisionRobotError):
        return 1, f"error: {error}"
    if isinstance(error, OSError) and error.strerror:  # a disk is full, a folder is gone
        return 1, f"error: {error.strerror}{f': {error.filename}' if error.filename else ''}"
    return 1, f"error: {type(error).__name__}: {error} (run again with {DEBUG} for the traceback)"


if __name__ == "__main__":
    main()
