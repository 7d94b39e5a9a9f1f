"""Options that the commands of `vr track` share."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli import completions

TrackerName = Annotated[
    str,
    typer.Option(
        "--tracker",
        help="background, rgb, optical-flow, their -plain forms, or a plug-in.",
        autocompletion=completions.trackers,
    ),
]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", help="An option of the tracker: rgb.tolerance=20. May be repeated; see --options."),
]
Config = Annotated[Path | None, typer.Option("--config", help="TOML file with a table for each tracker.")]
Color = Annotated[
    list[str] | None, typer.Option("--color", help="A colour by name: red, blue, ... May be repeated.")
]
Pick = Annotated[
    list[str] | None, typer.Option("--pick", help="A point u,v on the object in the first frame.")
]
Roi = Annotated[
    list[str] | None, typer.Option("--roi", help="A box left,top,width,height around it in the first frame.")
]
PlaneFile = Annotated[Path | None, typer.Option("--plane", help="File of the work plane, for millimetres.")]
CameraFile = Annotated[
    Path | None, typer.Option("--camera", help="Camera file, where another than the plane's is meant.")
]
Height = Annotated[
    str, typer.Option("--height", help="Height of what is tracked over the plane, with its unit.")
]
OverlayFile = Annotated[
    Path | None, typer.Option("--overlay", help="Video with masks, boxes, axes, ids and trails.")
]
RerunFile = Annotated[
    Path | None, typer.Option("--rerun", help="Recording for the rerun viewer (needs rerun-sdk).")
]
Gap = Annotated[
    float, typer.Option("--max-gap", help="Seconds an object may be out of sight and keep its id.")
]
Confirm = Annotated[int, typer.Option("--confirm", help="Sightings before an object counts.")]
Most = Annotated[
    int | None, typer.Option("--max-objects", help="How many objects there are at most, where that is known.")
]
Seconds = Annotated[
    float | None, typer.Option("--seconds", help="End after so many seconds; else with Ctrl-C.")
]
ListOptions = Annotated[bool, typer.Option("--options", help="List the tracker's options and end.")]
