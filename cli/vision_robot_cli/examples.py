"""Examples in the help of commands: lines of a docstring that begin with ``Example: vr``."""

import inspect
import re

__all__ = ["examples_in", "with_examples_whole"]

LINE = re.compile(r"^Example: (vr .+)$", re.MULTILINE)

UNWRAPPED = "\b"
"""What tells the help's formatter to keep the lines of a paragraph as they are."""


def examples_in(docstring: str) -> list[str]:
    """The command lines shown as examples."""
    return LINE.findall(inspect.cleandoc(docstring))


def with_examples_whole(docstring: str) -> str:
    """The docstring for `--help`: examples are not wrapped, so that they can be copied and pasted."""
    text = inspect.cleandoc(docstring)
    return LINE.sub(_alone, text).replace(f"\n\n\n{UNWRAPPED}", f"\n\n{UNWRAPPED}")


def _alone(match: re.Match[str]) -> str:
    return f"\n{UNWRAPPED}\nExample: {match[1]}\n"
