"""`vr measure`: pixels in, millimetres on the work plane out, each with its sigma."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import BoardName, BoardOption, BoardSize, Json, Out, Square

__all__ = ["measure"]


def measure(
    pixels: Annotated[
        list[str] | None, typer.Argument(help="Pixels u,v; (0, 0) is the centre of the first.")
    ] = None,
    plane: Annotated[
        Path | None, typer.Option("--plane", help="The file that 'vr extrinsics plane -o' wrote.")
    ] = None,
    csv: Annotated[Path | None, typer.Option(help="CSV with columns u_px,v_px[,sigma_px].")] = None,
    image: Annotated[
        Path | None,
        typer.Option(help="A photo: measures the board that lies in it, and says how well its size fits."),
    ] = None,
    board: BoardName = "chessboard",
    size: BoardSize = "9x6",
    square: Square = "25mm",
    board_option: BoardOption = None,
    sigma_px: Annotated[
        float, typer.Option(help="Noise of the pixels per axis, where the CSV has no sigma_px.")
    ] = 0.2,
    height: Annotated[str, typer.Option(help="The points' height over the plane: 6mm.")] = "0",
    height_sigma: Annotated[str, typer.Option(help="How well that height is known: 0.5mm.")] = "0",
    max_sigma: Annotated[
        float | None, typer.Option(help="Exit with 3 when a sigma [mm] is above this.")
    ] = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Measure on the table what a camera sees: pixels to millimetres, with the full uncertainty.

    Between points in a row lengths are given too: they share the camera's errors, so a length is known
    better than its ends.

    Example: vr measure 640,480 812.5,402 --plane plane.json --sigma-px 0.3
    """
    from vision_robot.files import check_place, write_text
    from vision_robot_cli import measuring
    from vision_robot_cli.output import check_limit, emit_json, note
    from vision_robot_cli.quantities import offset_m
    from vision_robot_cli.target import target

    if out:
        check_place(out)
    work_plane = measuring.work_plane(plane)
    chosen = target(board, size, square, board_option or ()) if image else None
    points = measuring.points(work_plane.camera, pixels or (), csv, image, chosen, sigma_px)
    found = measuring.measured(
        work_plane, points, offset_m(height, "--height"), offset_m(height_sigma, "--height-sigma")
    )
    if out:
        write_text(out, measuring.as_csv(found))
        note(f"points written to {out}")
    if json:
        emit_json("measure", measuring.as_json(found, plane))
    else:
        print(measuring.as_text(found))
    check_limit("sigma_mm", float(found.sigma_mm.max()), max_sigma, "mm")
