"""`vr extrinsics tool`: the robot's poses and where cameras saw the tip in; the tip on the wrist out."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import Json, Out, Report, Seed, Synthetic

__all__ = ["tool"]


def tool(
    folders: Annotated[
        list[Path] | None,
        typer.Argument(help="One folder of pictures for each fixed camera, in the order of the poses."),
    ] = None,
    poses: Annotated[
        Path | None, typer.Option(help="The robot's poses base_from_wrist, CSV or JSON as for hand-eye.")
    ] = None,
    tips: Annotated[
        list[Path] | None,
        typer.Option(help="Instead of pictures, a CSV for each camera: pose,u_px,v_px; poses count from 1."),
    ] = None,
    camera: Annotated[
        list[Path] | None,
        typer.Option(help="Camera file of each camera; its place is found along with the tip."),
    ] = None,
    hand_eye: Annotated[
        list[Path] | None,
        typer.Option(help="Instead of --camera: files of 'vr extrinsics hand-eye', cameras of known place."),
    ] = None,
    bead: Annotated[
        str, typer.Option(help="Colour of the bead on the tip: a name, or red,green,blue as 255,0,0.")
    ] = "red",
    pivot: Annotated[
        bool, typer.Option("--pivot", help="No cameras: the tip touches one point in all poses.")
    ] = False,
    synthetic: Synthetic = False,
    views: Annotated[int, typer.Option(help="Poses of the rendered set.")] = 20,
    max_sigma: Annotated[
        float | None, typer.Option(help="Exit with 3 when a sigma of the tip [mm] is above this.")
    ] = None,
    out: Out = None,
    report: Report = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Find the tool's tip in the wrist's frame, and how well it is known.

    The pictures show a bead of one colour on the tip. The wrist must tilt, or the cameras' places be known.

    Example: vr extrinsics tool left/ right/ --poses poses.csv --camera left.json --camera right.json
    """
    from vision_robot.files import check_place, write_text
    from vision_robot_cli import tool_input, tool_output
    from vision_robot_cli.output import check_limit, emit_json, note

    for place in (out, report):
        if place:
            check_place(place)
    given = (
        tool_input.rendered(views, seed)
        if synthetic
        else tool_input.given(
            poses, folders or (), tips or (), camera or (), hand_eye or (), bead, pivot=pivot
        )
    )
    found = tool_input.found(given)
    if out:
        write_text(out, tool_output.as_file(found))
        note(f"tool written to {out}")
    if report:
        tool_output.write_report(found, given, report, seed)
    if json:
        emit_json("tool", tool_output.as_json(found, given, seed))
    else:
        print(tool_output.as_text(found, given))
    check_limit("sigma_mm", 1000 * float(found.sigma.max()), max_sigma, "mm")
