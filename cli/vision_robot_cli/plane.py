"""`vr extrinsics plane`: photos of a board on the table in; the work plane before the camera out."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import (
    BoardName,
    BoardOption,
    BoardSize,
    CameraFile,
    CameraName,
    Json,
    Out,
    Report,
    Seed,
    Square,
    Synthetic,
)

__all__ = ["plane"]


def plane(
    images: Annotated[
        list[str] | None,
        typer.Argument(
            help="Photos by the fixed camera of the board lying on the table; the first defines {S}, "
            "in the others it may lie anywhere on the same table."
        ),
    ] = None,
    camera: CameraFile = None,
    camera_name: CameraName = None,
    board: BoardName = "chessboard",
    size: BoardSize = "9x6",
    square: Square = "25mm",
    board_option: BoardOption = None,
    points: Annotated[
        Path | None,
        typer.Option(help="CSV of points marked on the table instead: u_px,v_px,x_mm,y_mm[,sigma_px]."),
    ] = None,
    offset: Annotated[
        str, typer.Option(help="Where the board's first point lies in {S}: 120mm,-35mm.")
    ] = "0,0",
    yaw: Annotated[float, typer.Option(help="Angle from {S}'s x to the board's, about {S}'s z [deg].")] = 0.0,
    height: Annotated[
        str, typer.Option(help="Printed face over the plane: the board's thickness and what lies under it.")
    ] = "0",
    z: Annotated[
        str, typer.Option(help="up: {S} has z up off the table; down: its axes are the board's, z into it.")
    ] = "up",
    sigma_px: Annotated[
        float | None, typer.Option(help="Noise of the points per axis [px]; else told by the residuals.")
    ] = None,
    synthetic: Synthetic = False,
    max_rms: Annotated[
        float | None, typer.Option(help="Exit with 3 when the rms [px] is above this.")
    ] = None,
    out: Out = None,
    report: Report = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Find {S}, whose z = 0 is the table, before a fixed camera, and how well it is known.

    Example: vr extrinsics plane table/*.jpg --camera camera.json --height 3mm -o plane.json
    """
    from vision_robot.files import check_place
    from vision_robot.formats.work_plane import write_work_plane
    from vision_robot_cli import plane_input, plane_output
    from vision_robot_cli.output import check_limit, emit_json, note
    from vision_robot_cli.quantities import offset_m, offset_pair_m
    from vision_robot_cli.target import target

    for place in (out, report):
        if place:
            check_place(place)
    lies = plane_input.lying(
        offset_pair_m(offset, "--offset"), yaw, offset_m(height, "--height"), z, marked=points is not None
    )
    if synthetic:
        given = plane_input.rendered(target(board, size, square, board_option or ()), seed)
    else:
        known = plane_input.known_camera(camera, camera_name)
        given = (
            plane_input.from_points(points, known, lies)
            if points
            else plane_input.from_pictures(
                images or (), target(board, size, square, board_option or ()), known, lies
            )
        )
    found = plane_input.found(given, sigma_px)
    if out:
        write_work_plane(found.fit.plane, out)
        note(f"work plane written to {out}")
    if report:
        plane_output.write_report(found, given, report, seed)
    if json:
        emit_json("plane", plane_output.as_json(found, given, seed))
    else:
        print(plane_output.as_text(found, given))
    check_limit("rms_px", found.fit.rms_px, max_rms, "px")
