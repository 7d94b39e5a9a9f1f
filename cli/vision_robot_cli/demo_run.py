"""What `vr demo` does, chapter by chapter: from a camera that nobody knows to a rod that is put down."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from vision_robot.calibrate import Settings
from vision_robot.calibrate.detect import detect_board
from vision_robot.errors import BoardNotFound
from vision_robot.evaluate.tracking.figures import tracking_figures
from vision_robot.extrinsics.plane import PlaneFit, fit_plane, on_station
from vision_robot.geometry import SE3, KnownCamera
from vision_robot.pick.calibrated import BOARD, ON_TABLE, touched_station
from vision_robot.pick.episodes import Plan, run_episode
from vision_robot.pick.faults import with_fault
from vision_robot.pick.film import Film, Stills, film_size
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.world import World, ordinary_world
from vision_robot.report.demo import DemoStory
from vision_robot.report.pick import PickStory
from vision_robot.report.trackers import Answer, marked
from vision_robot.tracks import Tracks
from vision_robot.types import Image
from vision_robot.video import VideoWriter
from vision_robot_cli import calibration_input
from vision_robot_cli.calibration_verdict import Verdict, reached
from vision_robot_cli.output import note
from vision_robot_cli.pick_budget import in_processes

__all__ = ["Demo", "demo_run"]

TRACKERS: Mapping[str, Mapping[str, str]] = {"rgb": {"color": "red"}, "background": {}, "optical-flow": {}}
FRAMES_SHOWN = 4
FILM_FPS = 10.0
KNOCK_RAD = float(np.radians(1.0))
TARGETS = 2000
CELLS = 61
"""Of the drawing of the workspace, across."""


@dataclass(frozen=True)
class Demo:
    """The story, and what of it the other outputs need."""

    story: DemoStory
    verdict: Verdict
    given: calibration_input.CalibrationInput


class _Clock:
    """Seconds by chapter, told as they begin."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    def __call__(self, chapter: str, work: Callable[[], Any]) -> Any:
        note(f"{len(self.seconds) + 1}. {chapter}")
        start = perf_counter()
        result = work()
        self.seconds[chapter] = perf_counter() - start
        return result


def demo_run(out: Path, *, views: int, frames: int, episodes: int, workers: int, seed: int) -> Demo:
    """All chapters; pictures, videos and datasets are left in `out`."""
    world, clock = ordinary_world(), _Clock()
    given, verdict = clock("the camera", lambda: _camera(out, world, views, seed))
    known = KnownCamera(verdict.result.camera, verdict.result.covariance.intrinsics)
    fit, on_table = clock("the table", lambda: _table(world, known, seed))
    data, answers, shown = clock("three trackers", lambda: _trackers(out, frames, workers, seed))
    checks, reach = clock("the arm", lambda: _arm(world, seed))
    knowledge = _knowledge(world, fit, seed)
    picks = clock("the pick", lambda: _picks(out, world, knowledge, episodes, workers, seed))
    story = DemoStory(
        world, verdict.result, dict(given.pictures), fit, on_table, answers, data.truth, shown,
        tuple(checks), reach, picks, clock.seconds,
    )  # fmt: skip
    return Demo(story, verdict, given)


def _camera(
    out: Path, world: World, views: int, seed: int
) -> tuple[calibration_input.CalibrationInput, Verdict]:
    given = calibration_input.rendered_folder(out / "boards", views, seed, world.view.camera)
    return given, reached(given, [Settings()], seed)


def _table(world: World, known: KnownCamera, seed: int) -> tuple[PlaneFit, Image]:
    """The plane from a picture of a board that lies on it."""
    from vision_robot_synth.calibration import CalibrationSet

    station_from_board = on_station(ON_TABLE)
    pose = world.view.cam_from_station @ station_from_board
    batch = SE3(pose.rotation[None], pose.translation[None])
    lying = CalibrationSet(world.view.camera, BOARD, batch, seed)
    (image,) = lying.images()
    corners = detect_board(image, BOARD, name="on the table")
    if corners is None:
        raise BoardNotFound(1, f"chessboard {BOARD.size}")
    return fit_plane(known, [corners], BOARD.points, station_from_board), image


def _trackers(
    out: Path, frames: int, workers: int, seed: int
) -> tuple[Any, dict[str, Answer], tuple[Image, ...]]:
    from vision_robot.dataset import open_dataset
    from vision_robot_synth.making import synthesise
    from vision_robot_synth.recipe import read_recipe

    recipe = read_recipe("single-rod").with_video(frames=frames, size=(320, 240))
    synthesise(recipe, out / "video", seed=seed, workers=workers)
    data = open_dataset(out / "video")
    names = list(TRACKERS)
    found = in_processes(partial(_answer, out / "video", names), range(len(names)), workers)
    answers = dict(zip(names, found, strict=True))
    wanted = {int(k) for k in np.linspace(0, len(data) - 1, FRAMES_SHOWN)}
    shown = tuple(
        marked(frame.image, frame.index, answers) for frame in data.frames() if frame.index in wanted
    )
    return data, answers, shown


def _answer(folder: Path, names: list[str], index: int) -> Answer:
    from vision_robot.dataset import open_dataset
    from vision_robot.track.registry import tracker_named
    from vision_robot.track.session import Session

    name, data = names[index], open_dataset(folder)
    session = Session(tracker_named(name, TRACKERS[name]), plane=data.plane(0))
    parts = [step.final for step in session.run(data.frames())]
    tracks = Tracks.joined([*parts, session.rest()])
    figures = tracking_figures(data.truth, tracks)
    return Answer(tracks, {**figures, "ms_per_frame": session.latency.quantile_ms(0.5)})


def _arm(world: World, seed: int) -> tuple[Any, Any]:
    from vision_robot.arm.consistency import check_consistency
    from vision_robot.arm.ik import InverseKinematics
    from vision_robot.arm.workspace import workspace

    checks = check_consistency(world.arm, targets=TARGETS, seed=seed)
    return checks, workspace(InverseKinematics(world.arm), cells=CELLS)


def _knowledge(world: World, fit: PlaneFit, seed: int) -> Knowledge:
    station, covariance = touched_station(world, np.random.default_rng([seed, 1]))
    return Knowledge(fit.plane, station, world.arm, covariance)


def _picks(
    out: Path, world: World, knowledge: Knowledge, episodes: int, workers: int, seed: int
) -> dict[str, PickStory]:
    """The same seeds with the camera as it was and knocked, open loop and closed."""
    knocked = with_fault(world, "camera-rotation", KNOCK_RAD)
    conditions = {
        "open loop": (world, "open"),
        "camera knocked by 1°, open loop": (knocked, "open"),
        "camera knocked by 1°, look-move-look": (knocked, "look-move-look"),
    }
    jobs = [
        (name, where, Plan("rgb", {"color": "red"}, loop), seed + k)
        for k in range(episodes)
        for name, (where, loop) in conditions.items()
    ]
    work = partial(_job, out / "pick.mp4", knowledge, jobs)
    results = list(in_processes(work, range(-1, len(jobs)), workers))[1:]
    stories = {}
    for name, (where, loop) in conditions.items():
        mine = [result for job, result in zip(jobs, results, strict=True) if job[0] == name]
        stills = {episode.seed: pictures for episode, pictures in mine if pictures}
        plan = Plan("rgb", {"color": "red"}, loop)
        stories[name] = PickStory(plan, where, (), tuple(episode for episode, _ in mine), None, stills)
    return stories


def _job(film: Path, knowledge: Knowledge, jobs: list[tuple[str, World, Plan, int]], index: int) -> Any:
    """Job -1 films the first episode; of the others, those of the first seed are kept as stills."""
    name, world, plan, seed = jobs[max(index, 0)]
    del name
    if index < 0:
        with VideoWriter(film, film_size(world.view.camera), FILM_FPS) as video:
            return run_episode(world, plan, seed, knowledge, witness=Film(video.write, FILM_FPS))
    stills = Stills() if seed == jobs[0][3] else None
    episode = run_episode(world, plan, seed, knowledge, witness=stills)
    return episode, stills.pictures if stills else []
