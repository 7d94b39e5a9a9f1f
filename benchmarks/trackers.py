"""Trackers: how fast ours and the usual ways are on the same frames, and how near the truth ours come.

    python benchmarks/trackers.py [--part speed|pieces|accuracy] [--quick] [--json]

First table: milliseconds a frame (median) of whole trackers, from picture to blobs, at two sizes, on frames
of three things of different size that cross a noisy table, one thread each. Second: the pieces, each
beside what it replaces: blob analysis and scikit-image's regionprops on the same mask, the exact running
median and numpy's over the same window. Third: errors of centroid and yaw, recall and switched identities
on videos that `vr synth` makes; `rgb` is shown one point of each thing.
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from table import markdown, shown

from vision_robot.dataset import open_dataset
from vision_robot.evaluate.peers.registry import PEERS, peer_named
from vision_robot.evaluate.tracking import clear_scores, encounters
from vision_robot.evaluate.tracking.figures import tracking_figures
from vision_robot.track import tracker_named
from vision_robot.track.blob_analysis import analyse
from vision_robot.track.running_median import RunningMedian
from vision_robot.track.session import track
from vision_robot.track.tracker import LooksAhead, Tracker
from vision_robot.types import Array
from vision_robot_synth.making import synthesise
from vision_robot_synth.recipe import read_recipe

SIZES = ((640, 480), (1920, 1080))
WARM_UP = 10
BOX = ((0, 0, 150), (120, 120, 255))
"""Blue, green, red: what is red on the table that `drawn` makes."""
WINDOW = 51
PROPERTIES = ("area", "bbox", "centroid", "orientation", "axis_major_length", "axis_minor_length")


def drawn(size: tuple[int, int], count: int) -> list[Array]:
    """Frames of a red rod, a blue rod and a green square on a noisy table."""
    scale, rng = size[0] / 640, np.random.default_rng(0)
    coarse = rng.normal(120, 25, (size[1] // 8 + 1, size[0] // 8 + 1, 3)).astype(np.float32)
    table = cv2.GaussianBlur(cv2.resize(coarse, size, interpolation=cv2.INTER_CUBIC), (0, 0), 4)
    noises = [rng.normal(0, 2, (size[1], size[0], 3)).astype(np.float32) for _ in range(4)]
    frames = []
    for k in range(count):
        frame = table.copy()
        for j, (colour, length, across) in enumerate(
            (((40, 40, 220), 90, 14), ((200, 120, 40), 60, 18), ((60, 200, 60), 40, 40))
        ):
            centre = ((60 + 4 * k + 120 * j) * scale, (100 + 130 * j) * scale)
            box = cv2.boxPoints((centre, (length * scale, across * scale), 20.0 * j + k))
            cv2.fillConvexPoly(frame, np.rint(box).astype(np.int32), colour)
        frames.append(cv2.convertScaleAbs(frame + noises[k % 4]))
    return frames


def box_regionprops(frame: Array) -> object:
    """The usual RGB filter: a box of the cube, components, scikit-image's properties."""
    from skimage.measure import regionprops_table

    mask = cv2.inRange(frame, *BOX)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(mask)
    large = np.flatnonzero(stats[1:, cv2.CC_STAT_AREA] >= 30) + 1
    labels = np.where(np.isin(labels, large), labels, 0)
    return regionprops_table(labels, properties=PROPERTIES)


def trackers() -> Iterator[tuple[str, Callable[[list[Array]], Tracker]]]:
    """By name, how each is built for some frames."""
    red = {"color": "red"}
    for name, kind, options in (
        ("rgb", "rgb", red),
        ("rgb-plain", "rgb-plain", {}),
        ("background", "background", {}),
        ("background, median of every frame", "background", {"span_s": 0}),
        ("background, grey, every frame", "background", {"span_s": 0, "colour": "grey"}),
        ("background-plain", "background-plain", {}),
        ("optical-flow", "optical-flow", {}),
        ("optical-flow-plain", "optical-flow-plain", {}),
    ):
        yield name, lambda _, kind=kind, options=options: tracker_named(kind, options)
    for peer in PEERS:
        if peer.removeprefix("cv2-") in ("mog2", "knn", "cnt"):
            yield f"{peer}, median filter, blobs", lambda _, peer=peer: peer_named(peer)


def speed(sizes: tuple[tuple[int, int], ...], count: int) -> dict[str, dict[str, float]]:
    """Milliseconds a frame of each at each size."""
    rows: dict[str, dict[str, float]] = {}
    for size in sizes:
        frames = drawn(size, count)
        column = f"ms at {size[0]}x{size[1]}"
        for name, built in trackers():
            tracker = built(frames)
            if isinstance(tracker, LooksAhead):
                tracker.learn((frame, k / 25) for k, frame in enumerate(frames))
            taken = each(lambda k, frame, tracker=tracker: tracker.step(frame, k / 25), frames)
            rows.setdefault(name, {})[column] = float(np.median(taken[WARM_UP:]))
        taken = each(lambda _, frame: box_regionprops(frame), frames)
        rows.setdefault("cv2.inRange, components, regionprops", {})[column] = float(np.median(taken))
    return rows


def each(run: Callable[[int, Array], object], frames: list[Array]) -> list[float]:
    """Milliseconds of every frame."""
    return [milliseconds(partial(run, k, frame)) for k, frame in enumerate(frames)]


def milliseconds(run: Callable[[], object]) -> float:
    """One run."""
    start = time.perf_counter()
    run()
    return 1e3 * (time.perf_counter() - start)


def pieces(sizes: tuple[tuple[int, int], ...], repeats: int) -> dict[str, dict[str, float]]:
    """Times of ours and of what it replaces, their ratio, and the largest difference of their answers."""
    from skimage.measure import label, regionprops_table

    rows = {}
    rng = np.random.default_rng(0)
    for size in sizes:
        at = f"{size[0]}x{size[1]}"
        mask = np.zeros((size[1], size[0]), np.uint8)
        step = size[0] / 10
        for u, v in np.argwhere(np.ones((10, 7))):
            across, along = rng.uniform(step / 8, step / 3, 2)
            box = cv2.boxPoints(((step * (u + 0.5), step * (v + 0.5)), (across, along), rng.uniform(0, 180)))
            cv2.fillConvexPoly(mask, np.rint(box).astype(np.int32), 255)
        theirs = regionprops_table(label(mask > 0, connectivity=2), properties=PROPERTIES)
        ours = analyse(mask)
        apart = max(
            np.abs(ours.centroid_px - np.column_stack([theirs["centroid-1"], theirs["centroid-0"]])).max(),
            np.abs(ours.axes_px[:, 0] - theirs["axis_major_length"]).max(),
        )
        rows[f"blob analysis of {len(ours)} blobs, scikit-image, {at}"] = beside(
            lambda mask=mask: analyse(mask),
            lambda mask=mask: regionprops_table(label(mask > 0, connectivity=2), properties=PROPERTIES),
            repeats,
            apart,
        )
        frames = [frame.ravel() for frame in drawn(size, WINDOW + 10)]
        median = RunningMedian(frames[0].size, WINDOW)
        for frame in frames[:-1]:
            median.push(frame)
        window = np.stack(frames[-WINDOW:])
        taken = milliseconds(lambda median=median, frames=frames: median.push(frames[-1]))
        start = time.perf_counter()
        exact = np.median(window, axis=0)
        whole = 1e3 * (time.perf_counter() - start)
        rows[f"median of {WINDOW} RGB frames, numpy.median, {at}"] = {
            "ours, ms": taken,
            "the other, ms": whole,
            "faster": whole / taken,
            "difference": float(np.abs(median.median - exact).max()),
        }
    return rows


def beside(
    ours: Callable[[], object], theirs: Callable[[], object], repeats: int, apart: float
) -> dict[str, float]:
    """Medians of both."""
    a, b = (float(np.median([milliseconds(run) for _ in range(repeats)])) for run in (ours, theirs))
    return {"ours, ms": a, "the other, ms": b, "faster": b / a, "difference": float(apart)}


def accuracy(frames: int, size: tuple[int, int], seeds: int) -> dict[str, dict[str, float]]:
    """Errors on generated videos, means over the seeds."""
    rows: dict[str, dict[str, float]] = {}
    for recipe in ("single-rod", "many-objects"):
        told: dict[str, list[dict[str, float]]] = {}
        for seed in range(seeds):
            with tempfile.TemporaryDirectory() as place:
                chosen = read_recipe(recipe).with_video(frames=frames, size=size)
                synthesise(chosen, Path(place) / "set", seed=seed)
                dataset = open_dataset(Path(place) / "set")
                first = dataset.truth.rows(np.flatnonzero(dataset.truth.frame == dataset.truth.frame.min()))
                points = tuple(np.round(first.centroid_px, 1).ravel())
                for name in ("optical-flow", "rgb", "background"):
                    tracker = tracker_named(name, {"pick": points} if name == "rgb" else {})
                    answer = track(dataset, tracker, plane=dataset.plane())
                    figures = tracking_figures(dataset.truth, answer)
                    switches = clear_scores(encounters(dataset.truth, answer)).switches
                    told.setdefault(name, []).append({**figures, "id switches": switches})
        for name, some in told.items():
            rows[f"{recipe}: {name}"] = {
                key: float(np.nanmean([one[key] for one in some]))
                for key in (
                    "centroid_error_px",
                    "centroid_error_mm",
                    "yaw_error_deg",
                    "recall",
                    "id switches",
                )
            }
    return rows


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--part", choices=("speed", "pieces", "accuracy", "all"), default="all")
    parser.add_argument("--quick", action="store_true", help="small pictures, few of them")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    cv2.setNumThreads(1)
    quick = options.quick
    sizes = ((160, 120),) if quick else SIZES
    parts = {
        "speed": lambda: speed(sizes, 20 if quick else 80),
        "pieces": lambda: pieces(sizes, 2 if quick else 30),
        "accuracy": lambda: accuracy(
            12 if quick else 100, (320, 240) if quick else (640, 480), 1 if quick else 3
        ),
    }
    figures = {name: part() for name, part in parts.items() if options.part in (name, "all")}
    text = []
    for name, rows in figures.items():
        columns = [name, *next(iter(rows.values()))]
        body = [[key, *(f"{value:.3g}" for value in row.values())] for key, row in rows.items()]
        text.append(markdown(columns, body))
    print(shown("vr.benchmark.trackers/1", figures, "\n\n".join(text), as_json=options.json))


if __name__ == "__main__":
    main()
