"""`vr extrinsics hand-eye`: photos of a board and the arm's poses in; where the camera sits out."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import BoardName, BoardOption, BoardSize, Json, Out, Report, Seed, Square

__all__ = ["hand_eye"]


def hand_eye(
    images: Annotated[
        list[str] | None, typer.Argument(help="Photos, folders or quoted patterns, one picture a pose.")
    ] = None,
    poses: Annotated[
        Path | None,
        typer.Option(
            help="CSV or JSON of base_from_wrist (x, y, z and a rotation), or of joint values with --arm; "
            "paired by a column `image`, else by order."
        ),
    ] = None,
    camera: Annotated[Path | None, typer.Option(help="Camera file, as of vr calibrate; any format.")] = None,
    setup: Annotated[
        str, typer.Option(help="eye-in-hand (camera on the wrist) or eye-to-hand (board on the wrist).")
    ] = "eye-in-hand",
    board: BoardName = "chessboard",
    size: BoardSize = "9x6",
    square: Square = "25mm",
    board_option: BoardOption = None,
    corners: Annotated[
        Path | None, typer.Option(help="Folder of text files of corners instead of pictures.")
    ] = None,
    model_points: Annotated[
        Path | None, typer.Option(help="Text file of board points [m] for --corners.")
    ] = None,
    rotation: Annotated[
        str | None,
        typer.Option(help="What the rotation's numbers are: wxyz, xyzw, rotvec, columns, or xyz, ZYX, ..."),
    ] = None,
    pose_unit: Annotated[str | None, typer.Option(help="Unit of the poses' lengths: m, mm, cm, in.")] = None,
    angle_unit: Annotated[str | None, typer.Option(help="Unit of the poses' angles: rad or deg.")] = None,
    inverse: Annotated[bool, typer.Option("--inverse", help="The poses are wrist_from_base.")] = False,
    arm: Annotated[
        str | None, typer.Option(help="The arm's model, MJCF or URDF, or `column`: for joint values.")
    ] = None,
    geometry: Annotated[
        bool, typer.Option("--geometry", help="Correct the arm's links too; needs --arm and joint values.")
    ] = False,
    intrinsics: Annotated[
        str,
        typer.Option(
            help="known: as uncertain as the camera file says; fixed: exact; free: estimated afresh."
        ),
    ] = "known",
    synthetic: Annotated[
        bool, typer.Option("--synthetic", help="Render a set in MuJoCo and compare with its truth.")
    ] = False,
    views: Annotated[int, typer.Option(help="Views of --synthetic; with --auto the most of them.")] = 15,
    auto: Annotated[
        bool, typer.Option("--auto", help="With --synthetic: the arm drives to each next best pose.")
    ] = False,
    until: Annotated[
        str, typer.Option(help="With --auto: stop when the camera's position is known so well (one sigma).")
    ] = "0.3mm",
    link_error: Annotated[
        str,
        typer.Option(help="With --synthetic: how far true links are from the model, a sigma: 1mm,0.3deg."),
    ] = "0",
    keep: Annotated[
        Path | None, typer.Option(help="With --synthetic: write pictures, poses and camera to this folder.")
    ] = None,
    max_sigma: Annotated[
        float | None,
        typer.Option(help="Exit with 3 when the camera's position is known worse, one sigma [mm]."),
    ] = None,
    out: Out = None,
    report: Report = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Where the camera sits on the arm, or beside it, and how well that is known.

    Example: vr extrinsics hand-eye photos/*.jpg --poses poses.csv --camera camera.json -o hand_eye.json
    """
    from vision_robot.files import check_place
    from vision_robot.formats.hand_eye import write_hand_eye
    from vision_robot_cli import hand_eye_input, hand_eye_output
    from vision_robot_cli.hand_eye_auto import FIRST_VIEWS, driven, rendered
    from vision_robot_cli.hand_eye_input import HandEyeOptions
    from vision_robot_cli.hand_eye_verdict import solved
    from vision_robot_cli.output import check_limit, emit_json, note
    from vision_robot_cli.target import target

    for place in filter(None, (out, report)):
        check_place(place)
    asked = HandEyeOptions(setup, rotation, pose_unit, angle_unit, inverse, arm, geometry, intrinsics)
    asked.check(synthetic=synthetic, auto=auto, given=bool(images or corners or poses))
    if synthetic:
        chosen = target(board, size, square, board_option or ())
        first = FIRST_VIEWS if auto else views
        made = hand_eye_input.synthetic_set(asked, chosen, views=first, link_error=link_error, seed=seed)
        given = driven(made, asked, views, until, seed) if auto else rendered(made)
        if keep:
            hand_eye_input.keep_set(given, keep)
    elif corners or model_points:
        given = hand_eye_input.from_corner_files(corners, model_points, poses, camera, asked)
    else:
        chosen = target(board, size, square, board_option or ())
        given = hand_eye_input.from_pictures(images or (), chosen, poses, camera, asked)
    verdict = solved(given, asked, seed)
    result = verdict.result
    if out:
        write_hand_eye(result.hand_eye, out, result.geometry.chain if result.geometry else None)
        note(f"hand-eye written to {out}")
    if report:
        hand_eye_output.write_report(verdict, given, report, seed)
    if json:
        emit_json("extrinsics.hand-eye", hand_eye_output.as_json(verdict, given, seed))
    else:
        print(hand_eye_output.as_text(verdict, given))
    check_limit("position sigma", 1e3 * result.covariance.position_m, max_sigma, "mm")
