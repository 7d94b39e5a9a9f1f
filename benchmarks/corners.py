"""Error of corners to the truth: ours, cornerSubPix, OpenCV's sector detector, chess-corners where installed.

    python benchmarks/corners.py [--images 5] [--quick] [--json]

Pictures are projected exactly, through a lens that bends lines, and sampled by area; their blurs are not
the fit's own unless it says so. All start from the same detection. Figures are px rms per axis over the
corners that all who saw the board found; "sigma ok" is the share of ours within two of their own sigmas.
"""

import argparse
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import cv2
import numpy as np
from table import markdown, shown

from vision_robot.calibrate.boards.chessboard_order import canonical_grid
from vision_robot.calibrate.saddle import fit_grid
from vision_robot.types import Array, Float

sys.path.append(str(Path(__file__).parents[1]))
from tests.chessboard_pictures import BOARD, CAMERA, FINE, Picture, disc, picture, posed

SIZE, SHAPE = (BOARD.columns, BOARD.rows), (BOARD.rows, BOARD.columns, 2)
FAR = 3.0
"""Pixels from the truth beyond which a corner is another corner."""

FEW = 0.2
"""Share of corners that a method must find in a picture to be compared there."""

Method = Callable[[Picture], Float[Array, "n 2"] | None]


def gaussian(sigma_px: float) -> Float[Array, "k k"]:
    """Gaussian kernel on the fine grid of the pictures."""
    line = cv2.getGaussianKernel(2 * int(4 * sigma_px * FINE) + 1, sigma_px * FINE)
    return line @ line.T


def motion(length_px: float) -> Float[Array, "k k"]:
    """Blur by a move along one diagonal, slightly smoothed."""
    kernel = cv2.GaussianBlur(np.eye(int(length_px * FINE * 0.7) | 1), (0, 0), 1.5)
    return kernel / kernel.sum()


uu, vv = np.meshgrid(np.linspace(0, 1, CAMERA.width), np.linspace(0, 1, CAMERA.height))

TROUBLE: dict[str, tuple[dict, dict]] = {
    "clean": ({}, {}),
    "noise 10": ({}, {"blur": gaussian(0.5), "noise": 10}),
    "disc blur 2 px": ({}, {"blur": disc(4), "noise": 1}),
    "disc blur 3 px": ({}, {"blur": disc(6), "noise": 1}),
    "motion 6 px": ({}, {"blur": motion(6), "noise": 1}),
    "contrast 30, noise 4": ({}, {"blur": gaussian(0.7), "levels": (113, 143), "noise": 4}),
    "tilt 60-68": ({"tilt_deg": (60, 68), "distance_m": 0.27}, {"blur": gaussian(0.6), "noise": 1}),
    "squares of 10 px": ({"distance_m": 0.8}, {"blur": gaussian(0.5), "noise": 1}),
    "uneven light": ({}, {"blur": gaussian(0.7), "light": 0.35 + 0.75 * uu * vv, "noise": 1}),
}


def ours(shot: Picture) -> Float[Array, "n 2"]:
    """The saddle fit."""
    return fit_grid(shot.grey, start(shot).reshape(SHAPE)).pixels


def gradients(shot: Picture) -> Float[Array, "n 2"]:
    """OpenCV's cornerSubPix with the usual window of 5 px to each side."""
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 40, 0.001)
    pixels = start(shot).astype(np.float32).reshape(-1, 1, 2)
    return cv2.cornerSubPix(shot.grey, pixels, (5, 5), (-1, -1), stop).reshape(-1, 2)


def sectors(shot: Picture) -> Float[Array, "n 2"] | None:
    """OpenCV's findChessboardCornersSB at its most exact."""
    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_ACCURACY | cv2.CALIB_CB_EXHAUSTIVE
    found, pixels = cv2.findChessboardCornersSB(shot.grey, SIZE, flags=flags)
    if not found:
        return None
    return canonical_grid(shot.grey, np.asarray(pixels, dtype=float).reshape(SHAPE), SIZE).reshape(-1, 2)


def start(shot: Picture) -> Float[Array, "n 2"]:
    """Starts up to 0.4 px off per axis."""
    return shot.corners + np.random.default_rng(1).uniform(-0.4, 0.4, shot.corners.shape)


def chess(shot: Picture) -> Float[Array, "n 2"]:
    """PyPI's chess-corners with its saddle-point refiner; NaN where it misses a corner."""
    import chess_corners  # pyright: ignore[reportMissingImports]

    config = chess_corners.DetectorConfig().with_chess(refiner=chess_corners.ChessRefiner.saddle_point())
    seen = np.asarray(chess_corners.Detector(config).detect(np.ascontiguousarray(shot.grey)).xy, dtype=float)
    if not len(seen):
        return np.full_like(shot.corners, np.nan)
    distance = np.linalg.norm(shot.corners[:, None] - seen, axis=-1)
    near = distance.argmin(axis=1)
    return np.where(distance.min(axis=1)[:, None] < FAR, seen[near], np.nan)


METHODS: dict[str, Method] = {"ours": ours, "cornerSubPix 5": gradients, "SB": sectors}
if find_spec("chess_corners"):  # a peer: installed by hand with `uv pip install --no-deps chess-corners`
    METHODS["chess-corners"] = chess


def row(kind: str, images: int) -> dict[str, float]:
    """Figures of one kind of picture."""
    pose, trouble = TROUBLE[kind]
    errors: dict[str, list[Array]] = {name: [] for name in METHODS}
    inside = []
    for seed in range(images):
        shot = picture(posed(seed, **pose), **trouble, seed=seed)
        found = {name: method(shot) for name, method in METHODS.items()}
        misses = {name: pixels - shot.corners for name, pixels in found.items() if pixels is not None}
        near = {name: np.linalg.norm(miss, axis=1) < FAR for name, miss in misses.items()}
        # A picture in which a method finds next to nothing says nothing about the others' exactness.
        misses = {name: miss for name, miss in misses.items() if near[name].mean() > FEW}
        all_near = np.all([near[name] for name in misses], axis=0)
        for name, miss in misses.items():
            errors[name].append(miss[all_near])
        sigma = fit_grid(shot.grey, start(shot).reshape(SHAPE)).sigma_px
        inside.append((np.abs(misses["ours"]) < 2 * sigma[:, None]).mean())
    figures = {name: float(np.sqrt((np.concatenate(e) ** 2).mean())) for name, e in errors.items() if e}
    figures = {name: figures.get(name, float("nan")) for name in METHODS}
    peers = np.nanmin([value for name, value in figures.items() if name != "ours"])
    return {**figures, "ratio": float(peers / figures["ours"]), "sigma ok": float(np.mean(inside))}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--images", type=int, default=5)
    parser.add_argument("--quick", action="store_true", help="one picture of each kind")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    figures = {kind: row(kind, 1 if options.quick else options.images) for kind in TROUBLE}
    columns = ["picture", *next(iter(figures.values()))]
    rows = [
        [kind, *(f"{value:.{4 if name in METHODS else 2}f}" for name, value in row_of.items())]
        for kind, row_of in figures.items()
    ]
    print(shown("vr.benchmark.corners/1", figures, markdown(columns, rows), as_json=options.json))


if __name__ == "__main__":
    main()
