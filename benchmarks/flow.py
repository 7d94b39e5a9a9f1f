"""Flow: how fast and how near to its minimum Horn and Schunck's is, and how exact ours is beside the peers.

    python benchmarks/flow.py [--size 640x480] [--repeats 7] [--no-slow] [--quick] [--json]

First table: 100 sweeps as usual against the solver on two frames, with their distance from the minimiser
(rms, found by 30 cycles in float64). Second: endpoint error by kind of scene on rendered pairs with exact
flow, over the pixels that stay visible, and time for a pair, every method on the same pictures in one run
on one thread. Third: time for a frame of the whole trackers.
"""

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from table import markdown, shown

from vision_robot.flow import (
    FAST,
    FlowEquations,
    FlowEstimator,
    FlowSettings,
    Multigrid,
    cube,
    flow_error,
    horn_schunck,
    horn_schunck_sweeps,
    minimise,
)
from vision_robot.track import tracker_named
from vision_robot.types import Array, Float

sys.path.append(str(Path(__file__).parents[1]))
from tests.flow_scenes import Layer, Pair, affine, ellipse, noise_texture, rendered, rod

LONG_S = 2.0
"""Methods that take longer are timed once."""

Method = Callable[[Array, Array], Float[Array, "h w 2"]]

KINDS: dict[str, dict] = {
    "table moves 0.6 px": {"table": (0.6, -0.35), "things": 0},
    "turn and zoom": {"table": (1.5, -1), "turn_deg": 1, "zoom": 1.02, "things": 0},
    "small things, 2.5 px": {"move": 2.5},
    "rods, 8 px": {"move": 8},
    "all moves, 12 px": {"table": (-4, 2), "turn_deg": -0.7, "move": 12},
    "noise 8": {"table": (2, 1), "move": 4, "noise": 8},
    "exposure 1.1": {"table": (1, 0.5), "move": 4, "gain": 1.1},
    "large, 25 px": {"table": (-10, 4), "zoom": 1.03, "move": 25},
}


def textures(size: tuple[int, int], seed: int) -> list[Array]:
    """Photos from `mvtb-data` where it is installed, and random grey."""
    pictures = [noise_texture(size, seed=seed), noise_texture(size, seed=seed + 1, contrast=55)]
    try:
        import mvtbdata
    except ImportError:
        return pictures
    folder = Path(mvtbdata.__file__).parent / "images"
    for name in ("street.png", "church.jpg", "castle.png", "flowers1.png", "monalisa.png", "roof.png"):
        grey = cv2.imread(str(folder / name), cv2.IMREAD_GRAYSCALE)
        if grey is not None:
            scale = max(size[0] / grey.shape[1], size[1] / grey.shape[0])
            shape = (round(grey.shape[1] * scale), round(grey.shape[0] * scale))
            pictures.append(
                cv2.resize(grey, shape, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC)
            )
    return pictures


def scene(kind: str, size: tuple[int, int], seed: int) -> Pair:
    """Things on a table; motions are those of a picture 640 px wide, scaled."""
    told = KINDS[kind]
    rng = np.random.default_rng(seed)
    width, height = size
    scale, middle = width / 640, (width / 2, height / 2)
    stock = textures(size, seed)
    shift = np.asarray(told.get("table", (0, 0))) * scale
    motion = affine(
        (shift[0], shift[1]), turn_deg=told.get("turn_deg", 0), zoom=told.get("zoom", 1), about=middle
    )
    layers = [Layer(stock[int(rng.integers(len(stock)))], motion)]
    for k in range(told.get("things", 4)):
        centre = (float(rng.uniform(0.15, 0.85) * width), float(rng.uniform(0.15, 0.85) * height))
        away = rng.uniform(-1, 1, 2) * told.get("move", 0) * scale
        turned = affine((away[0], away[1]), turn_deg=rng.uniform(-5, 5), about=centre)
        angle = rng.uniform(0, 180)
        a, b = rng.uniform(30, 80) * scale, rng.uniform(30, 60) * scale
        long, slim = rng.uniform(100, 180) * scale, rng.uniform(14, 40) * scale
        outline = ellipse(centre, (a, b), angle) if k % 2 else rod(centre, long, slim, angle)
        texture = stock[int(rng.integers(len(stock)))]
        corner = (centre[0] - texture.shape[1] / 2, centre[1] - texture.shape[0] / 2)
        layers.append(Layer(texture, turned, outline, corner))
    return rendered(layers, size, noise=told.get("noise", 2), gain=told.get("gain", 1), seed=seed)


def methods(*, slow: bool) -> dict[str, Method]:
    """By name; those of ours keep their memory between pairs, as the peers' objects do."""
    ours, half, fast = (
        FlowEstimator(settings) for settings in (FlowSettings(), FlowSettings(halvings=1), FAST)
    )
    grids: dict[tuple[int, ...], Multigrid] = {}

    def classic(first: Array, second: Array) -> Array:
        memory = grids.setdefault(first.shape, Multigrid((first.shape[0], first.shape[1])))
        return np.moveaxis(horn_schunck(first, second, grids=memory).flow, 0, -1)

    presets = {
        "ultrafast": cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST,
        "fast": cv2.DISOPTICAL_FLOW_PRESET_FAST,
        "medium": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
    }
    found: dict[str, Method] = {
        "ours": lambda a, b: np.moveaxis(ours(a, b).flow, 0, -1),
        "ours, half size": lambda a, b: np.moveaxis(half(a, b).flow, 0, -1),
        "ours, FAST": lambda a, b: np.moveaxis(fast(a, b).flow, 0, -1),
        "Horn-Schunck, 100 sweeps": lambda a, b: np.moveaxis(horn_schunck_sweeps(a, b), 0, -1),
        "Horn-Schunck, minimum": classic,
        "Farnebäck": lambda a, b: cv2.calcOpticalFlowFarneback(
            a, b, np.zeros((*a.shape, 2), np.float32), 0.5, 5, 15, 3, 5, 1.2, 0
        ),
    }
    for name, preset in presets.items():
        peer = cv2.DISOpticalFlow.create(preset)
        found[f"DIS {name}"] = lambda a, b, peer=peer: peer.calc(a, b, None)  # type: ignore[call-overload]
    if slow:
        found["TV-L1"] = lambda a, b: cv2.optflow.DualTVL1OpticalFlow_create().calc(a, b, None)  # type: ignore
    return found


def seconds(run: Callable[[], object], repeats: int) -> float:
    """Median time."""
    taken = []
    start = time.perf_counter()
    run()
    if time.perf_counter() - start > LONG_S:
        return time.perf_counter() - start
    for _ in range(repeats):
        if sum(taken) > LONG_S:
            break
        start = time.perf_counter()
        run()
        taken.append(time.perf_counter() - start)
    return float(np.median(taken))


def solver(size: tuple[int, int], repeats: int) -> dict[str, dict[str, float]]:
    """Speed and distance from the minimiser."""
    pair = scene("turn and zoom", size, 2)
    first, second = pair.first, pair.second
    x, y, t = (plane.astype(float) for plane in cube(first, second))
    exact = FlowEquations(x, y, t, 15.0)
    truth = minimise(exact, tolerance_px=1e-7, most_cycles=30).flow
    grids = Multigrid((size[1], size[0]))
    warm = horn_schunck(first, second, grids=grids).flow

    def row(run: Callable[[], object], flow: Array, told: float) -> dict[str, float]:
        apart = np.sqrt(((flow - truth) ** 2).sum(axis=0))
        return {
            "ms": 1e3 * seconds(run, repeats),
            "distance rms px": float(np.sqrt((apart**2).mean())),
            "distance mean px": float(apart.mean()),
            "told px": told,
        }

    rows = {}
    for n in (10, 100):
        flow = horn_schunck_sweeps(first, second, sweeps=n)
        rows[f"{n} sweeps"] = row(lambda n=n: horn_schunck_sweeps(first, second, sweeps=n), flow, np.nan)
    for tolerance in (0.03, 0.01, 0.001):
        found = horn_schunck(first, second, tolerance_px=tolerance, grids=grids)
        rows[f"ours to {tolerance} px"] = row(
            lambda tolerance=tolerance: horn_schunck(first, second, tolerance_px=tolerance, grids=grids),
            found.flow,
            found.distance_px,
        )
    again = horn_schunck(first, second, grids=grids, start=warm)
    rows["ours, from its own answer"] = row(
        lambda: horn_schunck(first, second, grids=grids, start=warm), again.flow, again.distance_px
    )
    for figures in rows.values():
        figures["faster than 100 sweeps"] = rows["100 sweeps"]["ms"] / figures["ms"]
    return rows


def errors(size: tuple[int, int], seeds: int, repeats: int, *, slow: bool) -> dict[str, dict[str, float]]:
    """Errors of all methods on all kinds of scenes."""
    pairs = {kind: [scene(kind, size, seed) for seed in range(seeds)] for kind in KINDS}
    rows: dict[str, dict[str, float]] = {}
    for name, method in methods(slow=slow).items():
        row, all_errors = {}, []
        for kind, some in pairs.items():
            found = [flow_error(method(pair.first, pair.second), pair.flow, pair.visible) for pair in some]
            row[kind] = float(np.mean([error.endpoint_px for error in found]))
            all_errors += found
        one = pairs["rods, 8 px"][0]
        rows[name] = {
            **row,
            "mean EPE": float(np.mean([error.endpoint_px for error in all_errors])),
            "mean AAE deg": float(np.mean([error.angular_deg for error in all_errors])),
            "Fl %": 100 * float(np.mean([error.outlier_share for error in all_errors])),
            "ms": 1e3 * seconds(lambda method=method, one=one: method(one.first, one.second), repeats),
        }
    return rows


def trackers(size: tuple[int, int], frames: int) -> dict[str, dict[str, float]]:
    """Time for a frame: three things of different size that cross a noisy table."""
    scale = size[0] / 640
    rng = np.random.default_rng(0)
    table = cv2.merge([noise_texture(size, seed=k, contrast=25) for k in range(3)])
    video = []
    for k in range(frames):
        frame = table.copy()
        for j, (colour, length, across) in enumerate(
            (((40, 40, 220), 90, 14), ((200, 120, 40), 60, 18), ((60, 200, 60), 40, 40))
        ):
            centre = (round((60 + 4 * k + 120 * j) * scale), round((100 + 130 * j) * scale))
            box = cv2.boxPoints((centre, (length * scale, across * scale), 20.0 * j + k))
            cv2.fillConvexPoly(frame, np.rint(box).astype(np.int32), colour)
        video.append(np.clip(frame + rng.normal(0, 2, frame.shape), 0, 255).astype(np.uint8))
    rows = {}
    for name in ("optical-flow", "optical-flow-plain"):
        tracker, taken = tracker_named(name), []
        for k, frame in enumerate(video):
            start = time.perf_counter()
            tracker.step(frame, k / 25)
            taken.append(1e3 * (time.perf_counter() - start))
        steady = taken[5:]
        median = float(np.median(steady))
        rows[name] = {"ms p50": median, "ms p99": float(np.percentile(steady, 99)), "frames/s": 1e3 / median}
    return rows


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--part", choices=("solver", "errors", "trackers", "all"), default="all")
    parser.add_argument("--no-slow", action="store_true", help="leave out TV-L1, which takes seconds a pair")
    parser.add_argument("--quick", action="store_true", help="small pictures, once")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    width, height = (160, 120) if options.quick else map(int, options.size.split("x"))
    size, repeats = (width, height), 1 if options.quick else options.repeats
    cv2.setNumThreads(1)
    parts = {
        "solver": lambda: solver(size, repeats),
        "errors": lambda: errors(
            size, 1 if options.quick else options.seeds, repeats, slow=not options.no_slow
        ),
        "trackers": lambda: trackers(size, 15 if options.quick else 60),
    }
    figures = {name: part() for name, part in parts.items() if options.part in (name, "all")}
    text = []
    for name, rows in figures.items():
        columns = [name, *next(iter(rows.values()))]
        body = [[key, *(f"{value:.4g}" for value in row.values())] for key, row in rows.items()]
        text.append(markdown(columns, body))
    print(shown("vr.benchmark.flow/1", figures, "\n\n".join(text), as_json=options.json))


if __name__ == "__main__":
    main()
