"""`vr convert`: a camera or rig file of one tool in, that of another out."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import CameraName, Json

__all__ = ["convert"]


def convert(
    files: Annotated[
        list[Path],
        typer.Argument(help="Camera file of any tool; or one .cameramodel for each camera of a rig."),
    ],
    out: Annotated[
        Path, typer.Option("-o", "--out", help="File to write; a folder for a rig in mrcal's format.")
    ],
    source_format: Annotated[
        str | None,
        typer.Option("--from", help="native, opencv, ros, kalibr, colmap, mrcal or matlab; else by content."),
    ] = None,
    target_format: Annotated[str | None, typer.Option("--to", help="The same; else by the suffix.")] = None,
    camera_name: CameraName = None,
    image_size: Annotated[
        str | None, typer.Option(help="Picture size for files that do not hold it, such as 640x480.")
    ] = None,
    allow_loss: Annotated[
        bool, typer.Option("--allow-loss", help="Drop what the format has no place for.")
    ] = False,
    json: Json = False,
) -> None:
    """Convert a camera file between tools, exactly; what a format cannot hold is refused, not lost.

    Several cameras with their poses (our rig files, Kalibr's camchain, mrcal's .cameramodel files) stay a
    rig where the target can hold one.

    Example: vr convert camchain.yaml --camera-name cam0 -o camera.json
    """
    from vision_robot_cli import converting
    from vision_robot_cli.output import emit_json

    done = converting.converted(
        files, out, source_format, target_format, camera_name, image_size, allow_loss=allow_loss
    )
    if json:
        emit_json("convert", done)
    else:
        print(converting.as_text(done))
