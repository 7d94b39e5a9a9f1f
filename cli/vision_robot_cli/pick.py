"""`vr pick`: episodes of pick and place in the MuJoCo cell."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli import completions
from vision_robot_cli.arm_choice import ArmOption, Base, Tool
from vision_robot_cli.options import Json, Report, Seed

__all__ = ["pick"]


def pick(
    episodes: Annotated[int, typer.Option(help="How many, each with its own seed.")] = 10,
    loop: Annotated[str, typer.Option(help="open, or closed by look-move-look, position or image.")] = "open",
    tracker: Annotated[str, typer.Option(help="Name of the tracker that looks.")] = "rgb",
    options: Annotated[
        list[str] | None, typer.Option("--set", help="An option of the tracker: color=red. May be repeated.")
    ] = None,
    scene: Annotated[
        str,
        typer.Option(
            help="table, clutter (others lie close), wide (also out of sight or reach), or conveyor."
        ),
    ] = "table",
    objects: Annotated[
        list[str] | None,
        typer.Option(
            "--object",
            help="What to pick: rod, hexagon, pencil, box or disc, with size and colour if wanted, "
            "box:50x30x20mm:red. May be repeated: the first is picked, the others are in the way.",
        ),
    ] = None,
    recipe: Annotated[
        str | None,
        typer.Option(
            help="Things, table and light of a recipe of vr synth instead.",
            autocompletion=completions.recipes,
        ),
    ] = None,
    belt_speed: Annotated[str | None, typer.Option(help="Speed of the conveyor: 60mm/s.")] = None,
    fault: Annotated[
        list[str] | None,
        typer.Option(
            help="What is wrong with the cell: camera-rotation=1deg, camera-translation=5mm, square-size=2%, "
            "lens=pinhole, joint-offset=0.3deg, backlash=0.5deg, corner-noise=0.3px, image-noise=10, "
            "latency=100ms, lost-sight=20%. May be repeated: they add up."
        ),
    ] = None,
    arm: ArmOption = "column",
    tool: Tool = None,
    base: Base = None,
    tries: Annotated[int, typer.Option(help="How often to go for it when fingers close on nothing.")] = 1,
    budget: Annotated[
        bool,
        typer.Option(
            "--budget", help="Also share the error out among the stages, foretold and measured (2 s a seed)."
        ),
    ] = False,
    min_success: Annotated[
        float | None, typer.Option(help="Exit with 3 when the share of grasps is below this.")
    ] = None,
    video: Annotated[
        Path | None, typer.Option(help="Film the first episode, what is believed drawn in: pick.mp4.")
    ] = None,
    fps: Annotated[float, typer.Option(help="Pictures a second of the film.")] = 15.0,
    report: Report = None,
    workers: Annotated[int, typer.Option(help="Processes.")] = 1,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Pick a thing up and put it down, in physics, by what a calibrated camera sees.

    Example: vr pick --episodes 20 --loop look-move-look --fault camera-rotation=0.5deg

    Example: vr pick --scene conveyor --object box:40x25x15mm --belt-speed 80mm/s
    """
    from vision_robot.files import check_place
    from vision_robot_cli import pick_film, pick_output, pick_report
    from vision_robot_cli.output import check_least, emit_json
    from vision_robot_cli.pick_cell import CellWish
    from vision_robot_cli.pick_run import pick_run

    if report:
        check_place(report)
    if video:
        pick_film.check_film(video, fps)
    wish = CellWish(scene, objects or (), recipe, belt_speed, fault or (), arm, tool, base)
    run = pick_run(episodes, loop, tracker, options or (), wish, tries, budget, workers, seed)
    if video:
        pick_film.write_film(run.world, run.plan, seed, video, fps)
    if report:
        pick_report.write_report(run, report, seed)
    if json:
        emit_json("pick", pick_output.as_json(run))
    else:
        print(pick_output.as_text(run))
    check_least("grasp_success", pick_output.grasp_share(run), min_success)
