"""Options of a tracker: a frozen dataclass, filled from what people type."""

from collections.abc import Mapping
from dataclasses import MISSING, fields
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

from vision_robot.errors import BadParameter

__all__ = ["options_of"]

Options = TypeVar("Options")

NOTHING = ("auto", "none")
"""Words for None, "choose from the data"."""

TRUE, FALSE = ("1", "true", "yes", "on"), ("0", "false", "no", "off")


def options_of(cls: type[Options], given: Mapping[str, Any], tracker: str) -> Options:
    """An instance of the dataclass `cls` with the values given by name, texts turned into the fields' types.

    Dashes count as underscores. Raises BadParameter, naming the tracker, for a name it lacks (listing
    those it has with their defaults) and for a text that is no such value.
    """
    known = {one.name: one for one in fields(cls)}  # pyright: ignore[reportArgumentType]
    hints = get_type_hints(cls)
    values: dict[str, Any] = {}
    for word, value in given.items():
        name = word.replace("-", "_")
        if name not in known:
            listed = ", ".join(f"{one.name}={_shown(one)}" for one in known.values())
            raise BadParameter(f"option of tracker {tracker}", word, f"one of {listed}" if listed else "none")
        values[name] = _typed(hints[name], value, f"{tracker}.{name}")
    return cls(**values)


def _shown(one: Any) -> str:
    default = one.default if one.default is not MISSING else one.default_factory()
    if isinstance(default, tuple):
        return ",".join(map(str, default)) or "none"
    return "auto" if default is None else str(default)


def _typed(kind: Any, value: Any, where: str) -> Any:
    """A value as its field's type; what is no text is left to the dataclass to check, but for lists."""
    origin = get_origin(kind)
    if origin in (Union, UnionType):
        inner = [one for one in get_args(kind) if one is not NoneType]
        nothing = value is None or (isinstance(value, str) and value.strip().lower() in NOTHING)
        return None if nothing and NoneType in get_args(kind) else _typed(inner[0], value, where)
    if origin is tuple:
        return _sequence(get_args(kind), value, where)
    if kind is bool and isinstance(value, str):
        word = value.strip().lower()
        if word not in TRUE + FALSE:
            raise BadParameter(where, value, "yes or no")
        return word in TRUE
    if kind in (int, float) and (isinstance(value, str) or type(value) not in (bool, int, kind)):
        try:
            return kind(value)
        except (TypeError, ValueError):
            raise BadParameter(where, value, "a whole number" if kind is int else "a number") from None
    return value


def _sequence(kinds: tuple[Any, ...], value: Any, where: str) -> tuple[Any, ...]:
    items = [item.strip() for item in value.split(",")] if isinstance(value, str) else list(value)
    if len(kinds) == 2 and kinds[1] is Ellipsis:
        return tuple(_typed(kinds[0], item, where) for item in items)
    if len(items) != len(kinds):
        raise BadParameter(where, value, f"{len(kinds)} values with commas between")
    return tuple(_typed(kind, item, where) for kind, item in zip(kinds, items, strict=True))
