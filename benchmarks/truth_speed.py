"""Frames per second of a cell with its truth, beside a bare `mujoco.Renderer` colour loop.

The same scene, size and multisampling for all; everything moves between frames. Rounds over all
methods are interleaved; the median round is told.

- bare: `mujoco.Renderer`, `update_scene` and `render`, nothing else
- picture: our colours alone
- truth: `TruthRenderer.frame`: colours, masks and the truth of every object
- truth + flow: the same with depth, and true optical flow to the frame before
"""

import argparse
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from table import markdown, shown

from vision_robot.geometry import Camera
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import ArmMount, CellDesign, Item, Lights, StationCamera, look_at
from vision_robot.sim.gl import load_mujoco
from vision_robot.sim.paths import Circle
from vision_robot.sim.true_flow import true_flow
from vision_robot.sim.truth import TruthRenderer

SIZES = ((640, 480), (1280, 720))
COLOURS = ((0.85, 0.16, 0.12), (0.12, 0.3, 0.75), (0.1, 0.5, 0.25), (0.95, 0.75, 0.1))
STEP_S = 1 / 30


def design(count: int, *, arm: bool, shadows: bool) -> CellDesign:
    """Pencils on circles, all in the picture, with the arm beside them or without."""
    items = [
        Item(
            f"pencil{i}",
            colour=COLOURS[i % 4],
            path=Circle((0.12 * (i % 5) - 0.24, 0.1 * (i // 5) - 0.1), 0.03, 1.0, yaw_rad=i),
        )
        for i in range(count)
    ]
    reaching = ArmMount(start=(0.15, 0.4, -0.8, 0.0, 0.5)) if arm else None
    return CellDesign(items=tuple(items), arm=reaching, lights=Lights(shadows=shadows))


SCENES = {
    "1 pencil, no shadows": design(1, arm=False, shadows=False),
    "10 pencils and arm, no shadows": design(10, arm=True, shadows=False),
    "10 pencils and arm, shadows": design(10, arm=True, shadows=True),
}


@contextmanager
def bare(cell: Cell, view: StationCamera) -> Iterator[Callable[[], object]]:
    """MuJoCo's own renderer, its camera at about the same place."""
    mj, model, camera = load_mujoco(), cell.model, view.camera
    model.vis.quality.offsamples = 4
    model.vis.global_.offwidth, model.vis.global_.offheight = camera.width, camera.height
    model.vis.global_.fovy = np.degrees(2 * np.arctan(camera.height / 2 / camera.fy))
    eye = mj.MjvCamera()
    eye.lookat, eye.distance = cell.base_from_station.translation, 0.9
    eye.azimuth, eye.elevation = 0, -89.9
    with mj.Renderer(model, camera.height, camera.width) as renderer:

        def one() -> object:
            renderer.update_scene(cell.data, eye)
            return renderer.render()

        yield one


@contextmanager
def picture(cell: Cell, view: StationCamera) -> Iterator[Callable[[], object]]:
    """Our colours alone."""
    with TruthRenderer(cell, view) as eye:
        yield eye.picture


@contextmanager
def truth(cell: Cell, view: StationCamera) -> Iterator[Callable[[], object]]:
    """Colours and truth."""
    with TruthRenderer(cell, view) as eye:
        yield eye.frame


@contextmanager
def truth_and_flow(cell: Cell, view: StationCamera) -> Iterator[Callable[[], object]]:
    """Colours, truth and flow to the frame before."""
    with TruthRenderer(cell, view, depth=True) as eye:
        before = [eye.frame()]

        def one() -> object:
            after = eye.frame()
            flow = true_flow(before[0], after)
            before[0] = after
            return flow

        yield one


METHODS = {"bare": bare, "picture": picture, "truth": truth, "truth + flow": truth_and_flow}


def compared(scene: str, size: tuple[int, int], rounds: int, frames: int) -> list[dict]:
    """All methods on one scene at one size: one row each."""
    width, height = size
    focal = 0.95 * width
    view = look_at(Camera(width, height, focal, focal, (width - 1) / 2, (height - 1) / 2), (0, 0, 0.9))
    cell = Cell(SCENES[scene])
    seconds: dict[str, list[float]] = {name: [] for name in METHODS}
    for _ in range(rounds):
        for name, method in METHODS.items():
            with method(cell, view) as one:
                one()
                start = time.perf_counter()
                for i in range(frames):
                    cell.at(i * STEP_S)
                    one()
                seconds[name].append((time.perf_counter() - start) / frames)
    plain = np.median(seconds["bare"])
    return [
        {
            "scene": scene,
            "width": width,
            "height": height,
            "method": name,
            "ms": float(1e3 * np.median(times)),
            "fps": float(1 / np.median(times)),
            "of_bare": float(plain / np.median(times)),
        }
        for name, times in seconds.items()
    ]


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--frames", type=int, default=15, help="frames a round")
    parser.add_argument("--json", action="store_true")
    parser.add_argument(
        "--quick", action="store_true", help="one scene, few frames: only to see that it runs"
    )
    options = parser.parse_args()
    scenes, sizes = list(SCENES), SIZES
    if options.quick:
        scenes, sizes, options.rounds, options.frames = scenes[:1], ((160, 120),), 1, 2
    figures = [
        row
        for scene in scenes
        for size in sizes
        for row in compared(scene, size, options.rounds, options.frames)
    ]
    rows = [
        (
            f["scene"],
            f"{f['width']}x{f['height']}",
            f["method"],
            f"{f['ms']:.1f}",
            f"{f['fps']:.1f}",
            f"{f['of_bare']:.2f}",
        )
        for f in figures
    ]
    table = markdown(("scene", "size", "method", "ms a frame", "frames/s", "× bare"), rows)
    print(shown("vr.benchmark.truth_speed/1", figures, table, as_json=options.json))


if __name__ == "__main__":
    main()
