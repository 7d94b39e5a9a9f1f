"""`vr demo`: the main job in one go."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import Json, Seed

__all__ = ["demo"]


def demo(
    out: Annotated[
        Path, typer.Option("-o", "--out", help="Folder for pictures, videos, camera and page.")
    ] = Path("demo"),
    views: Annotated[int, typer.Option(help="Views of the board to render.")] = 24,
    frames: Annotated[int, typer.Option(help="Frames of the video that is tracked.")] = 60,
    episodes: Annotated[int, typer.Option(help="Picks under each of three conditions.")] = 4,
    workers: Annotated[int, typer.Option(help="Processes.")] = 2,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """From camera to grasp: calibrate, measure the table, track, solve the arm, pick and place; one page.

    Example: vr demo -o demo
    """
    from vision_robot.errors import BadParameter
    from vision_robot_cli import calibration_output, demo_output
    from vision_robot_cli.demo_run import demo_run
    from vision_robot_cli.output import emit_json, note

    for name, value, least in (("--views", views, 1), ("--frames", frames, 10), ("--episodes", episodes, 1),
                               ("--workers", workers, 1)):  # fmt: skip
        if value < least:
            raise BadParameter(name, value, f"a whole number from {least} on")
    done = demo_run(out, views=views, frames=frames, episodes=episodes, workers=workers, seed=seed)
    calibration_output.write_camera_file(done.verdict.result, out / "camera.yaml", None)
    calibration_output.write_report(done.verdict, done.given, out / "calibration.html", seed)
    demo_output.write_report(done, out / "report.html", seed)
    if json:
        emit_json("demo", demo_output.as_json(done, out, seed))
    else:
        print(demo_output.as_text(done))
    note(f"open {(out / 'report.html').resolve().as_uri()}")
