"""Held-out errors on the public left01...left14 photos: every lens and board shape, beside OpenCV.

    python benchmarks/photos.py            # the table
    python benchmarks/photos.py --honest   # and whether each covariance is

Photos of a 9x6 chessboard (25 mm), 640x480, from the PyPI package mvtb-data (they are
OpenCV's own samples). All errors are root mean squares per point, both axes together. Held
out: each view once, from a calibration of the others; its pose is fitted to it, six of its
2n numbers, which the error accounts for. OpenCV is given the same corners and the same folds
and finds the pose with solvePnP.
"""

import argparse
import pathlib
from collections.abc import Iterator, Sequence

import cv2
import mvtbdata
import numpy as np

from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.calibrate.boards.chessboard import Chessboard
from vision_robot.calibrate.judgement.bootstrap import bootstrap
from vision_robot.calibrate.judgement.halves import compare_halves
from vision_robot.calibrate.judgement.held_out import hold_back
from vision_robot.calibrate.judgement.selection import select
from vision_robot.errors import DegenerateViews, NoConvergence
from vision_robot.types import Array, Float, Image

BOARD = Chessboard(9, 6, 0.025)
SIZE = (640, 480)
DEGREES = range(7)
MODELS = ("pinhole", "brown5", "brown8", "fisheye")
OPENCV = {
    "pinhole": cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3,
    "brown5": 0,
    "brown8": cv2.CALIB_RATIONAL_MODEL,
}


def photos() -> Iterator[tuple[str, Image]]:
    """Names and grey pictures."""
    folder = pathlib.Path(mvtbdata.__file__).parent / "images" / "calibration"
    for path in sorted(folder.glob("left*.jpg")):
        picture = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
        assert picture is not None
        yield path.name, np.asarray(picture, dtype=np.uint8)


def detected() -> list[Corners]:
    """Corners of all photos by this library's detector."""
    seen = [(name, BOARD.detect(picture)) for name, picture in photos()]
    return [
        Corners(name, found.ids, found.pixels, found.sigma_px) for name, found in seen if found is not None
    ]


def detected_by_opencv(window: int) -> list[Corners]:
    """Corners by findChessboardCorners and cornerSubPix with a half-window [px]."""
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-4)
    views = []
    for name, grey in photos():
        found, pixels = cv2.findChessboardCorners(grey, (9, 6))
        if found:
            fine = cv2.cornerSubPix(
                grey, pixels.reshape(-1, 1, 2).astype(np.float32), (window, window), (-1, -1), stop
            )
            views.append(Corners(name, np.arange(54), fine.reshape(-1, 2).astype(float)))
    return views


def opencv_errors(views: Sequence[Corners], flags: int) -> tuple[float, float]:
    """OpenCV's rms in sample and held out [px], one view left out at a time."""
    rms, _, _ = _opencv_calibrated(views, flags)
    squares, freedom = 0.0, 0
    for i, view in enumerate(views):
        _, K, k = _opencv_calibrated([*views[:i], *views[i + 1 :]], flags)
        points, pixels = _for_opencv(view)
        _, rotvec, translation = cv2.solvePnP(points, pixels, K, k)
        stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-12)
        rotvec, translation = cv2.solvePnPRefineLM(points, pixels, K, k, rotvec, translation, stop)
        predicted, _ = cv2.projectPoints(points, rotvec, translation, K, k)
        squares += float(np.sum((predicted.reshape(-1, 2) - pixels) ** 2))
        freedom += 2 * len(view) - 6
    return rms, float(np.sqrt(2 * squares / freedom))


def _opencv_calibrated(views: Sequence[Corners], flags: int) -> tuple[float, Array, Array]:
    points, pixels = zip(*map(_for_opencv, views), strict=True)
    K, k = np.eye(3), np.zeros(5)
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 200, 1e-12)
    rms, K, k, *_ = cv2.calibrateCamera(points, pixels, SIZE, K, k, flags=flags, criteria=stop)  # pyright: ignore
    return float(rms), K, k


def _for_opencv(view: Corners) -> tuple[Float[Array, "n 3"], Float[Array, "n 2"]]:
    return BOARD.points[view.ids].astype(np.float32), view.pixels.astype(np.float32)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--honest", action="store_true", help="compare halves and draws with the covariances")
    parser.add_argument(
        "--quick", action="store_true", help="one lens and two board shapes: show that it runs"
    )
    asked = parser.parse_args()
    views = detected()
    print(f"{len(views)} views, {sum(map(len, views))} corners by the chessboard detector\n")
    print("model    warp   rms px  held-out px         fx       cx       cy  corners out")
    for model in MODELS if not asked.quick else ("brown5",):
        for degree in DEGREES if not asked.quick else (0, 2):
            try:
                result = calibrate(views, BOARD.points, SIZE, Settings(model=model, warp=degree))
                error = hold_back(result, BOARD.points, folds=len(views))
            except (DegenerateViews, NoConvergence) as failure:
                print(f"{model:8} {degree:4}   {failure}")
                continue
            camera = result.camera
            row = f"{model:8} {degree:4} {result.rms_px:8.4f} {error.rms_px:12.4f}   "
            row += f"{camera.fx:8.2f} {camera.cx:8.2f} {camera.cy:8.2f} {len(result.rejected):12}"
            if asked.honest:
                halves, drawn = compare_halves(result, BOARD.points), bootstrap(result, BOARD.points)
                row += f"   halves {halves.ratio:.2f}, bootstrap {drawn.typical_ratio:.2f} times as stated"
            print(row, flush=True)
    if asked.quick:
        return
    chosen = select(views, BOARD.points, SIZE, folds=len(views))
    row = chosen.chosen_index
    print(
        f"\nchosen: {chosen.chosen.model}, warp of degree {chosen.chosen.warp}, "
        f"held-out {chosen.held_out_px[row]:.4f} px: {chosen.why[row]}\n"
    )
    for name, corners in (("our corners", views), ("cornerSubPix 5", detected_by_opencv(5))):
        for model, flags in OPENCV.items():
            rms, error = opencv_errors(corners, flags)
            print(f"OpenCV {cv2.__version__}, {name}, {model}: rms {rms:.4f}, held-out {error:.4f} px")


if __name__ == "__main__":
    main()
