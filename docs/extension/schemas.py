"""A page for each JSON Schema that the program publishes."""

import json
from typing import Any

from vision_robot_cli.schemas import schema_named, schema_names

__all__ = ["schema_pages"]

DEEPEST = 3
"""Levels of keys in a table; the schema below it has them all."""


def schema_pages() -> dict[str, str]:
    """Markdown by file name."""
    return {"index.md": _index(), **{f"{name}.md": _page(name) for name in schema_names()}}


def _index() -> str:
    lines = [
        "# JSON output",
        "",
        "With `--json` a command prints exactly one object, whose key `schema` names its kind and version.",
        "JSON has no not-a-number: what could not be measured is `null`. Units are in the names of the keys;",
        "poses named `a_from_b` map points given in b to a, in metres and radians.",
        "",
        "Keys may be added to a kind; those listed here stay within its version",
        "([what stays, and for how long](../../deprecation.md)). `vr schema NAME` prints a JSON Schema",
        "(draft 2020-12) for a validator; tests hold every output of this tool against it.",
        "",
        "| schema | of |",
        "|---|---|",
    ]
    lines += [f"| [vr.{name}/1]({name}.md) | {schema_named(name)['title']} |" for name in schema_names()]
    return "\n".join([*lines, "", "```{toctree}", ":hidden:", *schema_names(), "```", ""])


def _page(name: str) -> str:
    schema = schema_named(name)
    parts = [f"# vr.{name}/1", "", schema["title"] + ".", ""]
    for one in schema.get("anyOf", [schema]):
        if one is not schema:
            parts += [f"## {one['title']}", ""]
        parts += ["| key | type | meaning |", "|---|---|---|"]
        parts += [row for key, told in one["properties"].items() for row in _rows(key, told, schema, one, 0)]
        parts.append("")
    text = json.dumps(schema, indent=1, ensure_ascii=False)
    return "\n".join([*parts, "## Schema", "", "```json", text, "```", ""])


def _rows(
    key: str, told: dict[str, Any], schema: dict[str, Any], holder: dict[str, Any], depth: int
) -> list[str]:
    """A row for the key, then those of what it holds."""
    if depth > DEEPEST:
        return []
    seen, nullable = _seen(told, schema)
    kind = _kind(seen, schema) + (" or null" if nullable else "")
    name = key.rpartition(".")[2].removesuffix("[]")
    optional = "" if name in holder.get("required", ()) else " (may be absent)"
    meaning = str(told.get("description") or seen.get("description") or "").replace("|", "\\|")
    rows = [f"| `{key}` | {kind}{optional} | {meaning} |"]
    inner, mark = (seen.get("items"), "[]") if seen.get("type") == "array" else (seen, "")
    inner = _seen(inner, schema)[0] if inner else {}
    if "$ref" in told or (inner is not None and "$ref" in (seen.get("items") or {})):
        return rows if depth else rows + _inside(key + mark, inner, schema, depth)
    return rows + _inside(key + mark, inner, schema, depth)


def _inside(key: str, part: dict[str, Any], schema: dict[str, Any], depth: int) -> list[str]:
    return [
        row
        for name, told in part.get("properties", {}).items()
        for row in _rows(f"{key}.{name}", told, schema, part, depth + 1)
    ]


def _seen(told: dict[str, Any], schema: dict[str, Any]) -> tuple[dict[str, Any], bool]:
    """What a part means, references followed, and whether it may be null."""
    nullable = False
    while "$ref" in told or "anyOf" in told:
        if "anyOf" in told:
            told, nullable = told["anyOf"][0], True
        else:
            told = schema["$defs"][told["$ref"].rpartition("/")[2]]
    return told, nullable


def _kind(told: dict[str, Any], schema: dict[str, Any]) -> str:
    if "const" in told:
        return f"`{told['const']}`"
    if "enum" in told:
        return ", ".join(f"`{one}`" for one in told["enum"])
    kind = told.get("type", "anything")
    if isinstance(kind, list):
        return " or ".join(kind)
    if kind == "array":
        count = f" of {told['minItems']}" if "minItems" in told else ""
        return f"array{count} of {_kind(_seen(told['items'], schema)[0], schema)}"
    if kind == "object" and isinstance(told.get("additionalProperties"), dict):
        return f"object of name: {_kind(_seen(told['additionalProperties'], schema)[0], schema)}"
    return kind
