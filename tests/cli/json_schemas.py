"""Validation of outputs against the schemas that are published."""

from functools import cache
from typing import Any

from jsonschema import Draft202012Validator

from vision_robot_cli.schemas import schema_named


def closed(part: Any) -> Any:
    """The schema without room for keys that it does not name.

    Those who read our output must bear further keys; we ourselves must describe all we write.
    """
    if isinstance(part, list):
        return [closed(one) for one in part]
    if not isinstance(part, dict):
        return part
    whole = {key: closed(value) for key, value in part.items()}
    return {"additionalProperties": False, **whole} if "properties" in part else whole


@cache
def validator(name: str) -> Draft202012Validator:
    return Draft202012Validator(closed(schema_named(name)))


def faults(result: dict[str, Any]) -> list[str]:
    """What an output has that its schema does not say, and the other way round."""
    found = validator(result["schema"]).iter_errors(result)
    return [f"{result['schema']} at {error.json_path}: {error.message[:300]}" for error in found]
