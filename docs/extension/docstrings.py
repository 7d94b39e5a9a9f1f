"""Docstrings of this project are plain text with `names` in single backticks, not reStructuredText."""

import re
from typing import Any

MARKED = re.compile(r"(?<!`)`([^`]+)`(?!`)")
SPECIAL = re.compile(r"([*|])|(\w)_(?=\W|$)")
LITERAL = re.compile(r"(``.+?``|:\w+:`[^`]+`)")

SECTIONS = ("Args:", "Returns:", "Raises:")
STEP = 4
"""Blanks before an argument's name; what goes on below it is farther in."""


def plain(line: str) -> str:
    """A line in which `names` are literal and nothing else means anything."""
    parts = LITERAL.split(MARKED.sub(r"``\1``", line))
    return "".join(part if i % 2 else SPECIAL.sub(_escaped, part) for i, part in enumerate(parts))


def _escaped(match: re.Match[str]) -> str:
    return f"\\{match[1]}" if match[1] else f"{match[2]}\\_"


def process(_app: Any, _what: str, _name: str, _obj: Any, _options: Any, lines: list[str]) -> None:
    """Sphinx hands over the lines of a docstring to be changed in place; literal blocks stay as they are."""
    block = section = False
    changed: list[str] = []
    for line in lines:
        inside = not line.strip() or line.startswith(" ")
        if block and inside:
            changed.append(line)
            continue
        block = line.rstrip().endswith("::")
        if line.strip() in SECTIONS:
            section = True
            changed += [line.strip(), ""]
            continue
        section = section and inside
        changed.append(_item(line) if section else plain(line))
    lines[:] = changed


def _item(line: str) -> str:
    """A line of a list of arguments: `name: text`, or the text going on."""
    depth = len(line) - len(line.lstrip())
    if depth > STEP or not line.strip():
        return f"  {plain(line.strip())}".rstrip()
    name, colon, text = line.strip().partition(":")
    return f"* ``{name}``{colon}{plain(text)}"


def setup(app: Any) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", process)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
