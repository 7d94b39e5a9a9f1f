"""`vr doctor`: what works on this machine."""

from typing import Annotated

import typer

from vision_robot_cli.options import Json
from vision_robot_cli.output import emit_json, note

__all__ = ["doctor"]

MARKS = {"ok": "ok", "absent": "--", "broken": "!!"}


def doctor(
    as_json: Json = False,
    full: Annotated[
        bool, typer.Option("--full", help="Also import every package and ask torch itself (about 10 s).")
    ] = False,
) -> None:
    """What works on this machine, with a real test render; and the command that mends the rest.

    Ends with 1 where something needed is broken.

    Example: vr doctor --json
    """
    from vision_robot.machine import Status, examine

    checks = examine(full=full)
    broken = [check for check in checks if check.status is Status.BROKEN]
    if as_json:
        rows = [
            {
                "topic": check.topic,
                "name": check.name,
                "status": check.status.value,
                "found": check.found,
                "mend": check.mend or None,
                "details": check.details,
            }
            for check in checks
        ]
        emit_json("doctor", {"ok": not broken, "checks": rows})
    else:
        for check in checks:
            print(f"{MARKS[check.status.value]}  {check.topic:<9} {check.name:<31} {check.found}")
            if check.mend:
                print(f"    {'mend with':<9} {check.mend}")
    if broken:
        note(f"vr: {len(broken)} needed thing(s) broken: {', '.join(check.name for check in broken)}")
        raise typer.Exit(1)
