"""A page for each command, from its own Typer function: so it is always true."""

import inspect
import re
from typing import Any

from vision_robot_cli.commands import COMMANDS, Command, Group, every_command
from vision_robot_cli.examples import LINE, examples_in
from vision_robot_cli.main import command_of, load
from vision_robot_cli.schemas import schema_names

__all__ = ["command_pages"]


def command_pages() -> dict[str, str]:
    """Markdown by file name, `index.md` with all of them included."""
    pages = {f"{'-'.join(words)}.md": _page(words, command) for words, command in every_command()}
    return {"index.md": _index(), **pages}


def _index() -> str:
    lines = [
        "# Commands",
        "",
        "Results go to stdout, progress and notes to stderr. Every command takes `--help`,",
        "`--json` where it has a result, and `--debug` for the traceback of an error.",
        "",
        "| exit code | means |",
        "|---|---|",
        "| 0 | done |",
        "| 1 | failed while running |",
        "| 2 | wrong usage or bad input: one line says what, where and how to mend it |",
        "| 3 | ran, but a limit that was given was missed (`--max-rms`, `--min-success`, `--baseline`) |",
        "| 130 | interrupted |",
        "",
    ]
    for name, found in COMMANDS.items():
        inner = found.commands if isinstance(found, Group) else {"": found}
        if isinstance(found, Group):
            lines += [f"**`vr {name}`** {found.help}", ""]
        for second, command in inner.items():
            words = f"{name} {second}".strip()
            lines += [f"[`vr {words}`]({words.replace(' ', '-')}.md)", f": {command.help}", ""]
    names = ["-".join(words) for words, _ in every_command()]
    return "\n".join([*lines, "```{toctree}", ":hidden:", *names, "```", ""])


def _page(words: tuple[str, ...], command: Command) -> str:
    function = load(command.target)
    text = inspect.cleandoc(function.__doc__ or "")
    spelt = " ".join(["vr", *words])
    built = command_of(words[-1], function)
    parts = [
        f"# {spelt}",
        "",
        _escaped(LINE.sub("", text).strip()),
        "",
        "```sh",
        *examples_in(text),
        "```",
        "",
    ]
    arguments = [one for one in built.params if one.param_type_name == "argument"]
    options = [one for one in built.params if one.param_type_name == "option" and one.name != "help"]
    if arguments:
        parts += ["## Arguments", "", *_table(arguments, _argument_name)]
    parts += ["## Options", "", *_table(options, _option_name)]
    schema = _schema_of(function)
    if schema:
        parts += [f"What `--json` prints: [{schema}](../json/{schema}.md).", ""]
    return "\n".join(parts)


def _table(parameters: list[Any], name_of: Any) -> list[str]:
    rows = ["| | meaning | default |", "|---|---|---|"]
    for one in parameters:
        rows.append(f"| {name_of(one)} | {_escaped(one.help or '')} | {_default(one)} |")
    return [*rows, ""]


def _argument_name(parameter: Any) -> str:
    more = "…" if parameter.nargs == -1 else ""
    return f"`{parameter.name}`{more}"


def _option_name(parameter: Any) -> str:
    return ", ".join(f"`{name}`" for name in parameter.opts)


def _default(parameter: Any) -> str:
    if parameter.required:
        return "needed"
    value = parameter.default
    if value is None or value is False or value in ((), []):
        return ""
    return f"`{value}`"


def _schema_of(function: Any) -> str | None:
    found = re.search(r'emit_json\("([^"]+)"', inspect.getsource(inspect.getmodule(function) or function))
    return found[1] if found and found[1] in schema_names() else None


def _escaped(text: str) -> str:
    """Text of a docstring as Markdown: nothing but backticks and paragraphs mean anything."""
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(
        part if i % 2 else re.sub(r"([\\<>*_|{}$\[\]])", r"\\\1", part) for i, part in enumerate(parts)
    )
