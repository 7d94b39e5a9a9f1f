"""`vr undistort`: pictures or a video in, the same without lens distortion out, with their new camera."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import CameraFile, CameraName, Json

__all__ = ["undistort"]


def undistort(
    images: Annotated[list[str], typer.Argument(help="Photos, folders, quoted patterns, or one video.")],
    camera: CameraFile = None,
    camera_name: CameraName = None,
    keep: Annotated[
        str,
        typer.Option(
            help="valid: no empty pixels; all: every pixel of the source; same: under the same camera matrix."
        ),
    ] = "valid",
    out: Annotated[
        Path, typer.Option("-o", "--out", help="Folder for pictures and their camera; or a video file.")
    ] = Path("undistorted"),
    file_format: Annotated[
        str | None, typer.Option("--format", help="Format of the new camera file; else our own JSON.")
    ] = None,
    json: Json = False,
) -> None:
    """Take the lens' distortion out of pictures, exactly, and write the pinhole camera they now have.

    Example: vr undistort photos/*.jpg --camera camera.json --keep all -o flat
    """
    from vision_robot_cli import undistorting
    from vision_robot_cli.output import emit_json

    done = undistorting.undistorted(images, camera, camera_name, keep, out, file_format)
    if json:
        emit_json("undistort", done)
    else:
        print(f"{done['pictures']} picture(s) in {done['out']}, their camera in {done['camera_file']}")
