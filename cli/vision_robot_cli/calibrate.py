"""`vr calibrate`: photos, a video, corner files or a rendered set in; a camera out."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli import completions
from vision_robot_cli.options import (
    BoardName,
    BoardOption,
    BoardSize,
    Json,
    Out,
    Report,
    Seed,
    Square,
    Topic,
)

__all__ = ["calibrate"]


def calibrate(
    images: Annotated[
        list[str] | None,
        typer.Argument(
            help="Photos, folders, quoted patterns, a video or ROS bag; nothing: a rendered set with truth."
        ),
    ] = None,
    topic: Topic = None,
    board: BoardName = "chessboard",
    size: BoardSize = "9x6",
    square: Square = "25mm",
    board_option: BoardOption = None,
    model: Annotated[
        str,
        typer.Option(
            help="pinhole, brown5, brown8 or fisheye; auto: by views held out.",
            autocompletion=completions.models,
        ),
    ] = "brown5",
    skew: Annotated[bool, typer.Option("--skew", help="Estimate the skew of the pixel axes too.")] = False,
    fix: Annotated[
        list[str] | None, typer.Option(help="Hold a parameter: k3, or k3=0.01. May be repeated.")
    ] = None,
    prior: Annotated[
        list[str] | None, typer.Option(help="What is known of a parameter: cx=640+-5. May be repeated.")
    ] = None,
    warp: Annotated[
        str,
        typer.Option(
            help="Degree of the board's unknown smooth shape; 0: as drawn; auto: by views held out."
        ),
    ] = "0",
    corners: Annotated[
        Path | None, typer.Option(help="Folder of text files of corners instead of pictures.")
    ] = None,
    model_points: Annotated[
        Path | None, typer.Option(help="Text file of board points for --corners.")
    ] = None,
    image_size: Annotated[
        str | None, typer.Option(help="Picture size for --corners, such as 640x480.")
    ] = None,
    views: Annotated[int, typer.Option(help="Views of the rendered set.")] = 24,
    max_rms: Annotated[
        float | None, typer.Option(help="Exit with 3 when the rms [px] is above this.")
    ] = None,
    out: Out = None,
    file_format: Annotated[
        str | None,
        typer.Option(
            "--format",
            help="Format of --out; else told by its name.",
            autocompletion=completions.camera_formats,
        ),
    ] = None,
    report: Report = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Calibrate a camera, and say how well it is known.

    Example: vr calibrate photos/*.jpg --size 9x6 --square 25mm -o camera.yaml --report camera.html
    Example: vr calibrate run.mcap --topic /camera/image_raw --size 9x6 --square 25mm -o camera.yaml
    """
    from vision_robot.files import check_place
    from vision_robot.formats import check_writable
    from vision_robot_cli import calibration_input, calibration_output
    from vision_robot_cli.calibration_verdict import reached
    from vision_robot_cli.output import check_limit, emit_json
    from vision_robot_cli.target import target

    candidates = calibration_input.candidates(model, skew, fix or (), prior or (), warp)
    if out:
        for candidate in candidates:
            check_writable(out, file_format, model=candidate.model, skew=skew)
    if report:
        check_place(report)
    if corners or model_points:
        given = calibration_input.from_corner_files(corners, model_points, image_size)
    else:
        chosen = target(board, size, square, board_option or ())
        given = (
            calibration_input.from_pictures(images, chosen, topic)
            if images
            else calibration_input.rendered(chosen, views, seed)
        )
    verdict = reached(given, candidates, seed)
    if out:
        calibration_output.write_camera_file(verdict.result, out, file_format)
    if report:
        calibration_output.write_report(verdict, given, report, seed)
    if json:
        emit_json("calibrate", calibration_output.as_json(verdict, given, seed))
    else:
        print(calibration_output.as_text(verdict, given))
    check_limit("rms_px", verdict.result.rms_px, max_rms, "px")
