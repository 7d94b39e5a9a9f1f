"""Boards that never tilt: focal length and distance cannot be told apart. Who says so?

    python benchmarks/untilted.py [--views 12] [--seeds 10] [--quick] [--json]

The board faces the camera squarely in every view, at several places and distances; corners carry noise
of 0.2 px. OpenCV's answer is given with its own standard deviation, ours as it is: a refusal that names
what cannot be known.
"""

import argparse

import cv2
import numpy as np
from table import markdown, shown

from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.errors import DegenerateViews
from vision_robot.geometry import SE3, Camera

CAMERA = Camera(1280, 960, 1000, 1010, 650, 470)
SIZE = (CAMERA.width, CAMERA.height)
NOISE_PX = 0.2
SQUARE_M = 0.025


def views(count: int, seed: int) -> tuple[np.ndarray, list[np.ndarray]]:
    """Board points (54, 3) [m], and their noisy pixels in each view."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(9), np.arange(6))
    points = SQUARE_M * np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    seen = []
    while len(seen) < count:
        z = rng.uniform(0.35, 0.6)
        shift = np.array([*(z * rng.uniform(-0.3, 0.3, 2)), z]) - points.mean(axis=0)
        pixels = CAMERA.project(SE3(np.eye(3), shift).apply(points))
        if ((pixels > 0) & (pixels < SIZE)).all():
            seen.append(pixels + rng.normal(0, NOISE_PX, pixels.shape))
    return points, seen


def opencv(points: np.ndarray, seen: list[np.ndarray]) -> tuple[float, float]:
    """Its fx and the standard deviation it states [px]."""
    pictures = [one.astype(np.float32) for one in seen]
    boards = [points.astype(np.float32)] * len(seen)
    none = (np.eye(3), np.zeros(5))
    found = cv2.calibrateCameraExtended(boards, pictures, SIZE, *none)
    return float(found[1][0, 0]), float(np.ravel(found[5])[0])


def ours(points: np.ndarray, seen: list[np.ndarray]) -> str:
    """What cannot be known, by our own words; fx with its sigma where it is claimed to be."""
    ids, sigma = np.arange(len(points)), np.full(len(points), NOISE_PX)
    corners = [Corners(f"view {i}", ids, one, sigma) for i, one in enumerate(seen)]
    try:
        result = calibrate(corners, points, SIZE, Settings(model="brown5"))
    except DegenerateViews as refusal:
        return f"refused: {', '.join(refusal.undetermined)}"
    return f"fx {result.camera.fx:.1f} +- {result.sigma['fx']:.2g} px"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--views", type=int, default=12)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--quick", action="store_true", help="one set, to show that it runs")
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    figures = []
    for seed in range(1 if given.quick else given.seeds):
        points, seen = views(given.views, seed)
        fx, sigma = opencv(points, seen)
        error = fx - CAMERA.fx
        figures.append({"seed": seed, "fx_error_px": error, "sigma_px": sigma, "ours": ours(points, seen)})
    cells = [
        [one["seed"], f"{one['fx_error_px']:+.0f}", f"{one['sigma_px']:.2g}", one["ours"]] for one in figures
    ]
    table = markdown(["seed", "OpenCV: error of fx, px", "its sigma, px", "ours"], cells)
    print(shown("vr.benchmark.untilted/1", figures, table, as_json=given.json))


if __name__ == "__main__":
    main()
