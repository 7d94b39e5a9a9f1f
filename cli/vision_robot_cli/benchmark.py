"""`vr benchmark`: suites of scenes, methods and seeds; scores with confidence intervals."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import Json, Report, Seed

__all__ = ["benchmark"]

SEEDS, QUICK_SEEDS = 12, 2


def benchmark(
    suite: Annotated[str, typer.Argument(help="calibration, trackers, flow, ik, grasp or all.")] = "all",
    scenes: Annotated[
        list[str] | None, typer.Option("--scene", help="Only this scene. May be repeated.")
    ] = None,
    methods: Annotated[
        list[str] | None, typer.Option("--method", help="Only this method. May be repeated.")
    ] = None,
    seeds: Annotated[
        int | None,
        typer.Option(help="Seeds of every scene, else 12, quick 2; fewer than 8 settle little."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer scenes and methods: minutes.")] = False,
    peers: Annotated[
        list[str] | None,
        typer.Option(
            "--peer", help="Suite trackers: also NAME=COMMAND, a program with the places {video} and {out}."
        ),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(help="Your own labelled data instead of rendered: a sequence, or a folder of them."),
    ] = None,
    frames: Annotated[int | None, typer.Option(help="Frames of every video; else the suite's own.")] = None,
    size: Annotated[str | None, typer.Option(help="Size of the pictures, such as 640x480.")] = None,
    workers: Annotated[int, typer.Option(help="Processes on this machine.")] = 1,
    time_limit: Annotated[
        float, typer.Option(help="Seconds after which one method on one scene is ended as failed.")
    ] = 600,
    scheduler: Annotated[
        str | None, typer.Option(help="A Dask cluster to run on instead: tcp://host:port.")
    ] = None,
    baseline: Annotated[
        Path | None,
        typer.Option(help="An older run's --json; exit with 3 where this is worse beyond noise."),
    ] = None,
    out: Annotated[
        Path, typer.Option("-o", "--out", help="Folder of results, where a run that was cut short goes on.")
    ] = Path("benchmark"),
    report: Report = None,
    tables: Annotated[
        Path | None, typer.Option(help="Folder for scores as CSV and JSON, summaries as CSV and LaTeX.")
    ] = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Measure methods against the truth, and say no more than the seeds allow.

    Example: vr benchmark calibration --seeds 5 --workers 2 --report calibration.html
    """
    from vision_robot.evaluate.score import read_scores
    from vision_robot.files import check_place
    from vision_robot_cli import benchmark_output
    from vision_robot_cli.benchmark_run import named_programs, run_suites
    from vision_robot_cli.output import emit_json
    from vision_robot_cli.quantities import whole_pair
    from vision_robot_synth.suites import Plan

    before = read_scores(baseline) if baseline else []
    if report:
        check_place(report)
    if tables:
        check_place(tables / "scores.csv")
    plan = Plan(
        tuple(scenes or ()),
        tuple(methods or ()),
        seeds if seeds is not None else (QUICK_SEEDS if quick else SEEDS),
        seed,
        frames,
        whole_pair(size, "--size") if size else None,
        quick,
        named_programs(peers or ()),
    )
    runs = run_suites(
        suite, plan, out, workers=workers, scheduler=scheduler, patience_s=time_limit, data=data
    )
    if report:
        benchmark_output.write_reports(runs, report, seed)
    if tables:
        benchmark_output.write_tables(runs, tables)
    if json:
        emit_json("benchmark", benchmark_output.as_json(runs))
    else:
        print(benchmark_output.as_text(runs))
    benchmark_output.check_baseline(runs, before)
