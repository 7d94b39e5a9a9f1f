"""Options that several commands share, so that they are spelt and explained the same everywhere."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli import completions

__all__ = [
    "BoardName",
    "BoardOption",
    "BoardSize",
    "CameraFile",
    "CameraName",
    "Json",
    "Out",
    "Report",
    "Seed",
    "Square",
    "Synthetic",
    "Topic",
]

BoardName = Annotated[
    str,
    typer.Option(
        "--board",
        help="chessboard, charuco, circles, acircles or aprilgrid.",
        autocompletion=completions.boards,
    ),
]
BoardSize = Annotated[
    str,
    typer.Option("--size", help="Across x down: inner corners; points of circles; squares of charuco; tags."),
]
Square = Annotated[
    str,
    typer.Option("--square", help="Side of a square or pitch of points, with its unit: 25mm, 1in, 0.025m."),
]
BoardOption = Annotated[
    list[str] | None,
    typer.Option(
        help="What one target has besides: dictionary=DICT_4X4_50, marker_ratio=0.7 or legacy=1 of charuco, "
        "spacing=0.3 of aprilgrid, diameter_m=0.01 of circles. May be repeated."
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Write one JSON object to stdout, nothing else.")]
Out = Annotated[Path | None, typer.Option("-o", "--out", help="Where the result is written.")]
Report = Annotated[Path | None, typer.Option("--report", help="Also write a self-contained HTML page.")]
Seed = Annotated[int, typer.Option("--seed", help="Seed of everything that is drawn by chance.")]
CameraFile = Annotated[
    Path | None,
    typer.Option("--camera", help="Camera file of any format; our own JSON carries its uncertainty."),
]
CameraName = Annotated[
    str | None, typer.Option(help="Which camera, where the file holds several (Kalibr, COLMAP).")
]
Synthetic = Annotated[
    bool, typer.Option("--synthetic", help="Pictures rendered in MuJoCo, the result beside the truth.")
]
Topic = Annotated[
    str | None, typer.Option("--topic", help="Topic of a ROS bag, where several of it hold pictures.")
]
