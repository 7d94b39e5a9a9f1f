"""How every command speaks: results on stdout, everything else on stderr."""

import json
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from rich.console import Console

__all__ = [
    "LimitMissed",
    "check_least",
    "check_limit",
    "console",
    "emit_json",
    "note",
    "plain",
    "progress",
    "ticking",
]

Item = TypeVar("Item")


class LimitMissed(Exception):
    """A measured value is worse than the limit the user gave; ends `vr` with exit code 3."""

    def __init__(self, name: str, value: float, limit: float, unit: str = ""):
        self.name, self.value, self.limit = name, value, limit
        unit = f" {unit}" if unit else ""
        super().__init__(f"limit missed: {name} is {value:.4g}{unit}, the limit is {limit:.4g}{unit}")


def check_limit(name: str, value: float, limit: float | None, unit: str = "") -> None:
    """Raise LimitMissed where a limit is given and `value` is above it or not a number.

    Call it last: the results are shown and written even when a limit is missed.
    """
    if limit is not None and not value <= limit:
        raise LimitMissed(name, value, limit, unit)


def check_least(name: str, value: float, limit: float | None, unit: str = "") -> None:
    """As `check_limit` for what should be large: raise LimitMissed where `value` is below the limit."""
    if limit is not None and not value >= limit:
        raise LimitMissed(name, value, limit, unit)


def emit_json(command: str, result: Mapping[str, Any], *, version: int = 1) -> None:
    """Write the one JSON object of a `--json` run, its "schema" key first."""
    print(json.dumps({"schema": f"vr.{command}/{version}", **plain(result)}, allow_nan=False))


def plain(value: Any) -> Any:
    """`value` as JSON can hold it: arrays as lists, dataclasses as objects, not-a-number as null."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, str | int):
        return value
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if hasattr(value, "tolist"):  # numpy arrays and scalars
        return plain(value.tolist())
    return [plain(item) for item in value] if isinstance(value, Iterable) else str(value)


def console() -> "Console":
    """A rich console on stderr, for tables and colours that are not the result."""
    from rich.console import Console

    return Console(stderr=True, highlight=False)


def note(text: str) -> None:
    """A line for the person at the terminal, on stderr."""
    print(text, file=sys.stderr, flush=True)


def progress(items: Iterable[Item], label: str, total: int | None = None) -> Iterator[Item]:
    """Pass `items` through, with a bar on stderr where that is a terminal and silence where not."""
    if not sys.stderr.isatty():
        yield from items
        return
    from rich.progress import track

    yield from track(items, description=label, total=total, console=console(), transient=True)


@contextmanager
def ticking(label: str) -> Iterator[Callable[[int, int], None]]:
    """A function to call with (done, total), which moves a bar on stderr where that is a terminal."""
    if not sys.stderr.isatty():
        yield lambda *_: None
        return
    from rich.progress import Progress

    with Progress(console=console(), transient=True) as bar:
        task = bar.add_task(label, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
