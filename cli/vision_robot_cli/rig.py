"""`vr extrinsics rig`: one folder of pictures a camera in; the cameras' places to each other out."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import (
    BoardName,
    BoardOption,
    BoardSize,
    Json,
    Out,
    Report,
    Seed,
    Square,
    Synthetic,
)

__all__ = ["rig"]


def rig(
    folders: Annotated[
        list[Path] | None,
        typer.Argument(help="One folder for each camera; pictures of one moment have the same file name."),
    ] = None,
    camera: Annotated[
        list[Path] | None,
        typer.Option(help="Camera file of each folder, in order; none: calibrated from the same pictures."),
    ] = None,
    board: BoardName = "chessboard",
    size: BoardSize = "9x6",
    square: Square = "25mm",
    board_option: BoardOption = None,
    model: Annotated[str, typer.Option(help="Lens model where no camera files are given.")] = "brown5",
    refine: Annotated[
        bool, typer.Option("--refine", help="Estimate the given cameras' intrinsics too, from what is known.")
    ] = False,
    warp: Annotated[
        int,
        typer.Option(help="Degree of the board's unknown smooth shape, shared; 0: as drawn."),
    ] = 0,
    synthetic: Synthetic = False,
    moments: Annotated[int, typer.Option(help="Moments of the rendered set.")] = 16,
    max_rms: Annotated[
        float | None, typer.Option(help="Exit with 3 when the rms [px] is above this.")
    ] = None,
    out: Out = None,
    report: Report = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Calibrate cameras that are fixed to each other from a board which two or more of them see at a time.

    The first camera's frame is the rig's. --out writes our own JSON (with the covariance), a Kalibr camchain
    (.yaml), or a folder of .cameramodel files.

    Example: vr extrinsics rig left/ right/ top/ --size 9x6 --square 25mm -o rig.json
    """
    from vision_robot.files import check_place
    from vision_robot.formats.rig import write_rig
    from vision_robot_cli import rig_input, rig_output
    from vision_robot_cli.output import check_limit, emit_json, note
    from vision_robot_cli.target import target

    for place in (out, report):
        if place and place.suffix:
            check_place(place)
    chosen = target(board, size, square, board_option or ())
    given = (
        rig_input.rendered(chosen, moments, seed, model)
        if synthetic
        else rig_input.from_folders(folders or (), camera or (), chosen, model)
    )
    found = rig_input.found(given, refine=refine or given.calibrated, warp=warp)
    if out:
        written = write_rig(found.fit.rig, out)
        note(f"rig written to {', '.join(map(str, written))}")
    if report:
        rig_output.write_report(found, given, report, seed)
    if json:
        emit_json("rig", rig_output.as_json(found, given, seed))
    else:
        print(rig_output.as_text(found, given))
    check_limit("rms_px", found.fit.rms_px, max_rms, "px")
