"""Speed, rms and memory of a calibration from corners, beside OpenCV and mrcal.

Views of an 11x8 board with 0.2 px noise, brown5, the same corners (rounded to float32) for all.
Each method runs in a process of its own, which warms up once, so that peak memory is its
own; rounds over all methods are interleaved, and the median of all repetitions is told.

- ours, complete: `calibrate`, from corners to covariance, outlier rejection on
- ours, refinement: the descent alone, from the closed-form start
- cv2: `cv2.calibrateCamera`
- mrcal: `mrcal.optimize`, from the same start as our refinement, its own regularisation,
  outlier rejection and board deformation off; in another interpreter where
  `--mrcal-python` names one, left out where none has it
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from refinement_mrcal import peak_mb
from synthetic import COLUMNS, ROWS, SQUARE_M, TYPICAL, some_views
from table import markdown, shown

from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.refine import refine
from vision_robot.calibrate.start import start
from vision_robot.calibrate.state import State
from vision_robot.calibrate.warp import Warp
from vision_robot.geometry import SE3, Camera

METHODS = ("ours, complete", "ours, refinement", "cv2", "mrcal")
MODEL = "brown5"
NOISE_PX = 0.2


def main() -> None:
    """Run and print, or, as a worker, measure one method."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--views", type=int, nargs="+", default=[10, 50, 100, 1000])
    parser.add_argument("--rounds", type=int, default=3, help="how often each method is started")
    parser.add_argument("--repetitions", type=int, default=5, help="runs a round, after a warm-up")
    parser.add_argument("--mrcal-python", default=sys.executable, help="interpreter that can import mrcal")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quick", action="store_true", help="10 views, once: only to see that it runs")
    parser.add_argument(
        "--worker", nargs=3, metavar=("METHOD", "DATA", "REPETITIONS"), help=argparse.SUPPRESS
    )
    options = parser.parse_args()
    if options.worker:
        method, data, repetitions = options.worker
        print(json.dumps(measured(method, Path(data), int(repetitions))))
        return
    if options.quick:
        options.views, options.rounds, options.repetitions = [10], 1, 1
    figures = []
    with tempfile.TemporaryDirectory() as folder:
        for views in options.views:
            data = Path(folder) / f"{views}.npz"
            write(data, views)
            figures += compared(data, views, options)
    print(shown("vr.benchmark.refinement/1", figures, told(figures), as_json=options.json))


def write(path: Path, views: int) -> None:
    """Corners, and the start that our refinement and mrcal share."""
    camera = Camera(1280, 960, 1000, 1010, 650, 470, 0, MODEL, TYPICAL[MODEL])
    made = some_views(camera, views, seed=views, noise_px=NOISE_PX)
    pixels = np.array([view.pixels for view in made.corners], dtype=np.float32)
    seen = Observations.of(listed(pixels), made.board)
    state = start(seen, made.size, Settings(model=MODEL), Warp.none(len(made.board)))
    pose = state.cam_from_board
    np.savez(
        path,
        pixels=pixels,
        board=made.board,
        size=made.size,
        parameters=state.camera.parameters,
        rotvec=pose.rotvec(),
        translation=pose.translation,
        columns=COLUMNS,
        rows=ROWS,
        square_m=SQUARE_M,
    )


def listed(pixels: np.ndarray) -> list[Corners]:
    """Corners of whole boards."""
    ids = np.arange(pixels.shape[1])
    return [Corners(f"view {i}", ids, view.astype(float)) for i, view in enumerate(pixels)]


def compared(data: Path, views: int, options: argparse.Namespace) -> list[dict]:
    """All methods on the same corners: one row each."""
    found: dict[str, list[dict]] = {}
    for _ in range(options.rounds):
        for method in METHODS:
            answer = asked(method, data, options)
            if answer is not None:
                found.setdefault(method, []).append(answer)
    rows = []
    for method, rounds in found.items():
        rows.append(
            {
                "views": views,
                "method": method,
                "seconds": float(np.median([s for one in rounds for s in one["seconds"]])),
                "cpu_seconds": float(np.median([s for one in rounds for s in one["cpu_seconds"]])),
                "rms_px": rounds[0]["rms_px"],
                "memory_mb": float(np.median([one["memory_mb"] for one in rounds])),
            }
        )
    return rows


def asked(method: str, data: Path, options: argparse.Namespace) -> dict | None:
    """What a worker process measured; None, and a line on stderr, where it cannot run."""
    here = Path(__file__)
    command = [sys.executable, str(here), "--worker", method, str(data), str(options.repetitions)]
    if method == "mrcal":
        peer = here.with_name("refinement_mrcal.py")
        command = [options.mrcal_python, str(peer), str(data), str(options.repetitions)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        why = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
        print(f"{method} left out: {why}", file=sys.stderr)
        return None
    return json.loads(done.stdout.strip().splitlines()[-1])


def measured(method: str, path: Path, repetitions: int) -> dict:
    """Seconds of each repetition, rms per point and growth of the peak memory."""
    data = dict(np.load(path))
    run = {"ours, complete": complete, "ours, refinement": refinement, "cv2": opencv}[method](data)
    before = peak_mb(afresh=True)
    rms = run()
    grown = peak_mb() - before
    seconds, cpu = [], []
    for _ in range(repetitions):
        wall, busy = time.perf_counter(), time.process_time()
        run()
        seconds.append(time.perf_counter() - wall)
        cpu.append(time.process_time() - busy)
    return {"seconds": seconds, "cpu_seconds": cpu, "rms_px": rms, "memory_mb": grown}


def complete(data: dict) -> Callable[[], float]:
    """`calibrate`."""
    corners, size = listed(data["pixels"]), (int(data["size"][0]), int(data["size"][1]))
    return lambda: calibrate(corners, data["board"], size, Settings(model=MODEL)).rms_px


def refinement(data: dict) -> Callable[[], float]:
    """The descent from the start in the file."""
    corners, size = listed(data["pixels"]), data["size"]
    k = tuple(data["parameters"][5:])
    camera = Camera(int(size[0]), int(size[1]), *data["parameters"][:5], model=MODEL, distortion=k)
    problem = Problem.plain(Observations.of(corners, data["board"]), Settings(model=MODEL).free)
    pose = SE3.from_rotvec(data["rotvec"], data["translation"])
    state = State(camera, pose, Warp.none(len(data["board"])))
    points = data["pixels"].shape[0] * data["pixels"].shape[1]
    return lambda: float(np.sqrt(2 * refine(state, problem).equations.cost / points))


def opencv(data: dict) -> Callable[[], float]:
    """`cv2.calibrateCamera`, brown5 being its default."""
    import cv2

    pixels = [view.reshape(-1, 1, 2) for view in data["pixels"]]
    board = [data["board"].astype(np.float32)] * len(pixels)
    size = (int(data["size"][0]), int(data["size"][1]))
    return lambda: float(cv2.calibrateCamera(board, pixels, size, None, None)[0])  # type: ignore[call-overload]


def told(figures: list[dict]) -> str:
    """The table, and how the cost grows."""
    rows = []
    for row in figures:
        same = [other for other in figures if other["views"] == row["views"]]
        ours = next(other for other in same if other["method"] == METHODS[0])
        alone = next(other for other in same if other["method"] == METHODS[1])
        rows.append(
            (
                row["views"],
                row["method"],
                f"{row['seconds']:.4f}",
                f"{row['cpu_seconds']:.4f}",
                f"{row['seconds'] / ours['seconds']:.2f}",
                f"{row['seconds'] / alone['seconds']:.2f}",
                f"{row['rms_px']:.7f}",
                f"{row['rms_px'] - ours['rms_px']:+.1e}",
                f"{row['memory_mb']:.1f}",
            )
        )
    columns = (
        *("views", "method", "s", "CPU s", "× complete", "× refinement"),
        *("rms px", "- ours", "peak MB more"),
    )
    table = markdown(columns, rows)
    lines = []
    for method in METHODS:
        own = [row for row in figures if row["method"] == method]
        if len(own) > 1:
            (n0, t0, m0), (n1, t1, m1) = ((r["views"], r["seconds"], r["memory_mb"]) for r in own[-2:])
            power = np.log(t1 / t0) / np.log(n1 / n0)
            memory = f"{1000 * (m1 - m0) / (n1 - n0):.0f} kB a view"
            lines.append(f"{method}: time grows as views^{power:.2f} from {n0} to {n1}, memory by {memory}.")
    return "\n".join([table, "", *lines]).strip()


if __name__ == "__main__":
    main()
