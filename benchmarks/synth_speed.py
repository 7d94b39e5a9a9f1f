"""Frames per second of `vr synth`, end to end, beside a bare `mujoco.Renderer` colour loop.

End to end is what a dataset costs: colours, masks, truth of every object, optical flow, the sensor,
PNG files of picture, masks and flow, the notes for the tables. The bare loop renders colours of the same
scene at the same size and multisampling, and throws them away. Each runs in processes of its own,
which start together; rounds are interleaved and the medians told. Where OpenGL runs on the CPU its
drawing is spread over all cores, so on two cores the bare loop is to be held against two workers,
which use the same two; CPU time a frame compares them whatever the number of cores.
"""

import argparse
import multiprocessing
import tempfile
import time
from multiprocessing.synchronize import Barrier
from pathlib import Path

import cv2
import numpy as np
from table import markdown, shown

from vision_robot.sim.cell import Cell
from vision_robot.sim.gl import load_mujoco
from vision_robot_synth.making.frame_files import Workshop
from vision_robot_synth.making.maker import Maker
from vision_robot_synth.recipe import read_recipe
from vision_robot_synth.scene.scene import Scene, scene_of

SIZES = ((640, 480), (1280, 720))
RECIPES = ("single-rod", "many-objects", "conveyor", "gripper-approach")
WARM_UP = 2


Seconds = tuple[float, float]
"""By the clock, and of CPU."""


def now() -> Seconds:
    """Both clocks."""
    return time.perf_counter(), time.process_time()


def since(begun: Seconds) -> Seconds:
    """Seconds gone."""
    wall, cpu = now()
    return wall - begun[0], cpu - begun[1]


def end_to_end(scene: Scene, frames: int, start: Barrier) -> Seconds:
    """Seconds for so many frames."""
    with tempfile.TemporaryDirectory() as place:
        workshop = Workshop(Path(place) / "set", Path(place) / "notes")
        with Maker(scene, workshop) as maker:
            list(maker.make(0, WARM_UP))
            start.wait()
            begun = now()
            list(maker.make(WARM_UP, WARM_UP + frames))
            return since(begun)


def bare(scene: Scene, frames: int, start: Barrier) -> Seconds:
    """The same for MuJoCo's own renderer, its camera at about the same place."""
    mj, cell, camera = load_mujoco(), Cell(scene.design), scene.view.camera
    model, fps = cell.model, scene.recipe.video.fps
    model.vis.quality.offsamples = 4
    model.vis.global_.offwidth, model.vis.global_.offheight = camera.width, camera.height
    model.vis.global_.fovy = np.degrees(2 * np.arctan(camera.height / 2 / camera.fy))
    station_from_cam = scene.view.cam_from_station.inverse()
    eye, ahead = mj.MjvCamera(), station_from_cam.rotation[:, 2]
    eye.lookat, eye.distance = (
        cell.base_from_station.translation,
        np.linalg.norm(station_from_cam.translation),
    )
    eye.azimuth, eye.elevation = np.degrees([np.arctan2(ahead[1], ahead[0]), np.arcsin(ahead[2])])
    with mj.Renderer(model, camera.height, camera.width) as renderer:

        def one(frame: int) -> None:
            cell.at(frame / fps)
            renderer.update_scene(cell.data, eye)
            renderer.render()

        one(0)
        start.wait()
        begun = now()
        for frame in range(frames):
            one(frame)
        return since(begun)


def run(task, scene, frames, start, seconds) -> None:
    """What a process does."""
    cv2.setNumThreads(1)
    seconds.put(task(scene, frames, start))


def rate(task, scene: Scene, frames: int, workers: int) -> tuple[float, float]:
    """Frames per second of so many processes together, and their CPU seconds a frame."""
    context = multiprocessing.get_context("spawn")
    start, seconds = context.Barrier(workers), context.Queue()
    processes = [
        context.Process(target=run, args=(task, scene, frames, start, seconds)) for _ in range(workers)
    ]
    for process in processes:
        process.start()
    wall, cpu = zip(*(seconds.get() for _ in processes), strict=True)
    for process in processes:
        process.join()
    return workers * frames / max(wall), sum(cpu) / (workers * frames)


METHODS = (("bare", bare, 1), ("1 worker", end_to_end, 1), ("2 workers", end_to_end, 2))


def compared(recipe: str, size: tuple[int, int], rounds: int, frames: int) -> dict:
    """One row of the table."""
    chosen = read_recipe(recipe).with_video(frames=frames + WARM_UP + 2, size=size)
    scene = scene_of(chosen.at(0.5), 0)
    rates: dict[str, list[tuple[float, float]]] = {name: [] for name, _, _ in METHODS}
    for _ in range(rounds):
        for name, task, workers in METHODS:
            rates[name].append(rate(task, scene, frames, workers))
    plain, one, two = (np.median(rates[name], axis=0).tolist() for name, _, _ in METHODS)
    return {
        "recipe": recipe,
        "size": list(size),
        "bare_fps": plain[0],
        "one_worker_fps": one[0],
        "two_workers_fps": two[0],
        "of_bare": one[0] / plain[0],
        "two_of_one": two[0] / one[0],
        "two_of_bare": two[0] / plain[0],
        "bare_cpu_ms": 1e3 * plain[1],
        "one_worker_cpu_ms": 1e3 * one[1],
        "two_workers_cpu_ms": 1e3 * two[1],
        "of_bare_by_cpu": plain[1] / one[1],
    }


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--recipes", nargs="+", default=list(RECIPES))
    parser.add_argument("--sizes", nargs="+", default=[f"{w}x{h}" for w, h in SIZES])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--frames", type=int, default=40, help="frames a round")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quick", action="store_true", help="few small frames: only to see that it runs")
    options = parser.parse_args()
    if options.quick:
        options.recipes, options.sizes, options.rounds, options.frames = ["single-rod"], ["96x72"], 1, 2
    figures = [
        compared(recipe, (int(size.split("x")[0]), int(size.split("x")[1])), options.rounds, options.frames)
        for recipe in options.recipes
        for size in options.sizes
    ]
    rows = [
        (
            f["recipe"],
            "x".join(map(str, f["size"])),
            *(f"{f[name]:.1f}" for name in ("bare_fps", "one_worker_fps")),
            f"{f['of_bare']:.2f}",
            f"{f['two_workers_fps']:.1f}",
            f"{f['two_of_one']:.2f}",
            f"{f['two_of_bare']:.2f}",
            *(f"{f[name]:.1f}" for name in ("bare_cpu_ms", "one_worker_cpu_ms", "two_workers_cpu_ms")),
            f"{f['of_bare_by_cpu']:.2f}",
        )
        for f in figures
    ]
    columns = (
        "recipe", "size", "bare loop, frames/s", "vr synth", "× bare", "2 workers", "× 1 worker", "× bare",
        "CPU ms a frame: bare", "1 worker", "2 workers", "× bare by CPU",
    )  # fmt: skip
    print(shown("vr.benchmark.synth_speed/1", figures, markdown(columns, rows), as_json=options.json))


if __name__ == "__main__":
    main()
