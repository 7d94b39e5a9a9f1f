"""JSON Schemas of what `--json` prints and of the JSON files this tool writes.

A file a schema, named as the key `schema` of what it describes: `calibrate.json` is for vr.calibrate/1. Parts
that several share are in `definitions.json`. Keys may be added to an output; those named here stay, as the
deprecation policy of the manual says.
"""

import json
from importlib.resources import files
from typing import Any

from vision_robot.errors import BadParameter

__all__ = ["schema_named", "schema_names"]

PREFIX = "#/$defs/"
SHARED = "definitions"


def schema_names() -> list[str]:
    """All names, in alphabetical order."""
    found = (
        one.name.removesuffix(".json") for one in files(__name__).iterdir() if one.name.endswith(".json")
    )
    return sorted(name for name in found if name != SHARED)


def schema_named(name: str) -> dict[str, Any]:
    """A complete schema, by `calibrate` or `vr.calibrate/1`. Raises BadParameter, listing those there are."""
    short = name.removeprefix("vr.").partition("/")[0]
    if short not in schema_names():
        raise BadParameter("schema", name, f"one of {', '.join(schema_names())}")
    schema, shared = _read(short), _read(SHARED)["$defs"]
    used = _used(schema)
    while more := set().union(*(_used(shared[one]) for one in used)) - used:
        used |= more
    return {**schema, "$defs": {one: shared[one] for one in shared if one in used}} if used else schema


def _read(name: str) -> dict[str, Any]:
    return json.loads((files(__name__) / f"{name}.json").read_text(encoding="utf-8"))


def _used(part: Any) -> set[str]:
    """Names of the shared parts that a part refers to."""
    if isinstance(part, list):
        return set().union(*map(_used, part))
    if not isinstance(part, dict):
        return set()
    own = {part["$ref"].removeprefix(PREFIX)} if isinstance(part.get("$ref"), str) else set()
    return own.union(*(_used(value) for value in part.values()))
