"""Docstrings of this project are plain text with `names` in single backticks, not reStructuredText."""

import re
from typing import Any

MARKED = re.compile(r"(?<!`)`([^`]+)`(?!`)")
SPECIAL = re.compile(r"([*|])|(\w)_(?=\W|$)")
LITERAL = re.compile(r"(``.+?``|:\w+:`[^`]+`)")


def plain(line: str) -> str:
    """A line in which `names` are literal and nothing else means anything."""
    parts = LITERAL.split(MARKED.sub(r"``\1``", line))
    return "".join(part if i % 2 else SPECIAL.sub(_escaped, part) for i, part in enumerate(parts))


def _escaped(match: re.Match[str]) -> str:
    return f"\\{match[1]}" if match[1] else f"{match[2]}\\_"


def process(_app: Any, _what: str, _name: str, _obj: Any, _options: Any, lines: list[str]) -> None:
    """Sphinx hands over the lines of a docstring to be changed in place; indented blocks stay as they are."""
    block = False
    for i, line in enumerate(lines):
        if block and (not line.strip() or line.startswith(" ")):
            continue
        block = line.rstrip().endswith("::")
        lines[i] = plain(line)


def setup(app: Any) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", process)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
