"""`vr schema`: what the keys of `--json` mean, for programs."""

from typing import Annotated

import typer

from vision_robot_cli import completions
from vision_robot_cli.options import Json

__all__ = ["schema"]


def schema(
    name: Annotated[
        str | None,
        typer.Argument(
            help="Name as in the key schema: calibrate, or vr.calibrate/1.",
            autocompletion=completions.schemas,
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Print the JSON Schema of a command's --json or of a file; without a name, list them all.

    Example: vr schema calibrate
    """
    from json import dumps

    from vision_robot_cli.output import emit_json
    from vision_robot_cli.schemas import schema_named, schema_names

    if name is not None:
        print(dumps(schema_named(name), indent=2, ensure_ascii=False))
        return
    listed = [
        {"name": one, "id": f"vr.{one}/1", "title": schema_named(one)["title"]} for one in schema_names()
    ]
    if json:
        emit_json("schema", {"schemas": listed})
        return
    width = max(len(row["name"]) for row in listed)
    print("\n".join(f"{row['name']:<{width}}  {row['title']}" for row in listed))
