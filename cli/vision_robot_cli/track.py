"""`vr track video`, `vr track camera`: where objects are, how they lie and how fast they move."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import Json, Out, Report, Topic
from vision_robot_cli.track_options import (
    CameraFile,
    Color,
    Config,
    Confirm,
    Gap,
    Height,
    ListOptions,
    Most,
    OverlayFile,
    Pick,
    PlaneFile,
    RerunFile,
    Roi,
    Seconds,
    Set,
    TrackerName,
)

__all__ = ["camera", "video"]


def video(
    file: Annotated[Path, typer.Argument(help="The video, or a ROS bag.")],
    topic: Topic = None,
    tracker: TrackerName = "background",
    color: Color = None,
    pick: Pick = None,
    roi: Roi = None,
    set_: Set = None,
    config: Config = None,
    plane: PlaneFile = None,
    camera: CameraFile = None,
    height: Height = "0mm",
    max_gap: Gap = 1.0,
    confirm: Confirm = 3,
    max_objects: Most = None,
    out: Out = None,
    overlay: OverlayFile = None,
    report: Report = None,
    rerun: RerunFile = None,
    options: ListOptions = False,
    json: Json = False,
) -> None:
    """Track objects in a video from a fixed camera: -o tracks.csv, tracks.json or mot.txt.

    Example: vr track video belt.mp4 --tracker rgb --color red -o tracks.csv --report tracks.html
    Example: vr track video run.mcap --topic /camera/image_raw -o tracks.csv
    """
    from vision_robot.track.sources import open_recording
    from vision_robot_cli.track_input import plane_of, tracker_of
    from vision_robot_cli.track_run import Outputs

    chosen = tracker_of(tracker, set_ or (), config, color=color or (), pick=pick or (), roi=roi or ())
    if options:
        _list_options(chosen)
        return
    outputs = Outputs(out, overlay, report, rerun)
    outputs.check()
    session = _session(chosen, plane_of(camera, plane), height, max_gap, confirm, max_objects)
    source = open_recording(file, topic)
    _through(session, source, str(file), outputs, source.fps, source.frame_count, json)


def camera(
    number: Annotated[int, typer.Argument(help="Which camera: 0 is the first.")] = 0,
    tracker: TrackerName = "background",
    color: Color = None,
    pick: Pick = None,
    roi: Roi = None,
    set_: Set = None,
    config: Config = None,
    plane: PlaneFile = None,
    camera: CameraFile = None,
    height: Height = "0mm",
    max_gap: Gap = 1.0,
    confirm: Confirm = 3,
    max_objects: Most = None,
    seconds: Seconds = None,
    out: Out = None,
    overlay: OverlayFile = None,
    report: Report = None,
    rerun: RerunFile = None,
    json: Json = False,
) -> None:
    """Track objects before a camera until Ctrl-C; all rows so far are kept.

    Example: vr track camera 0 --tracker rgb --color red --plane plane.json -o tracks.csv
    """
    from itertools import takewhile

    from vision_robot.track.sources import CameraStream
    from vision_robot_cli.track_input import plane_of, tracker_of
    from vision_robot_cli.track_run import Outputs

    chosen = tracker_of(tracker, set_ or (), config, color=color or (), pick=pick or (), roi=roi or ())
    outputs = Outputs(out, overlay, report, rerun)
    outputs.check()
    session = _session(chosen, plane_of(camera, plane), height, max_gap, confirm, max_objects)
    stream = CameraStream(number)
    frames = takewhile(lambda frame: seconds is None or frame.time_s < seconds, stream)
    _through(session, frames, f"camera {number}", outputs, 25.0, None, json)


def _session(chosen, plane, height: str, max_gap: float, confirm: int, max_objects: int | None):
    from vision_robot.track.follow import FollowOptions
    from vision_robot.track.session import Session
    from vision_robot_cli.quantities import length_m

    z_m = 0.0 if height.strip() in ("0", "0mm", "0m") else length_m(height, "--height")
    follow = FollowOptions(confirm=confirm, max_gap_s=max_gap, max_objects=max_objects)
    return Session(chosen, follow=follow, plane=plane, z_m=z_m)


def _through(session, source, name: str, outputs, fps: float, total: int | None, json: bool) -> None:
    from vision_robot_cli.output import emit_json, note, ticking
    from vision_robot_cli.track_run import Run

    run = Run(session, outputs)
    with ticking(f"tracking {name}") as tick:
        run.go(source, fps, tick, total)
    run.write_report(name)
    if json:
        emit_json("track", run.summary())
    else:
        print(run.text())
    for path in (outputs.rows, outputs.overlay, outputs.rerun):
        if path:
            note(f"written to {path}")
    if run.failure:
        raise run.failure
    if run.interrupted:
        raise typer.Exit(130)


def _list_options(chosen) -> None:
    from dataclasses import fields

    for one in fields(chosen.options):
        value = getattr(chosen.options, one.name)
        print(f"{chosen.name}.{one.name} = {'auto' if value is None else value}")
