"""`vr demo`: the main job in one go."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import Json, Seed

__all__ = ["demo"]


def demo(
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for pictures, camera and page.")] = Path(
        "demo"
    ),
    views: Annotated[int, typer.Option(help="Views of the board to render.")] = 24,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Render a board, calibrate from the pictures, and show the camera found beside the truth.

    Example: vr demo -o demo
    """
    from vision_robot.calibrate import Settings
    from vision_robot_cli import calibration_input, calibration_output
    from vision_robot_cli.calibration_verdict import reached
    from vision_robot_cli.output import emit_json, note

    given = calibration_input.rendered_folder(out / "boards", views, seed)
    verdict = reached(given, [Settings()], seed)
    calibration_output.write_camera_file(verdict.result, out / "camera.yaml", None)
    calibration_output.write_report(verdict, given, out / "report.html", seed)
    if json:
        emit_json("demo", {"calibration": calibration_output.as_json(verdict, given, seed), "out": out})
    else:
        print(calibration_output.as_text(verdict, given))
    note(f"open {(out / 'report.html').resolve().as_uri()}")
