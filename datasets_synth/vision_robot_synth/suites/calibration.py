"""Suite `calibration`: detectors and estimators on rendered boards, by degradation and number of views."""

from collections.abc import Sequence
from pathlib import Path
from time import process_time

import numpy as np

from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.calibrate.boards import Chessboard
from vision_robot.calibrate.detect import detect_board
from vision_robot.errors import BoardNotFound
from vision_robot.evaluate.dial import scene_at
from vision_robot.evaluate.peers.opencv_calibration import opencv_camera, opencv_corners
from vision_robot.evaluate.projection import projection_error
from vision_robot.evaluate.sweep import Cell
from vision_robot.geometry import Camera
from vision_robot.types import Image
from vision_robot_synth.calibration import CalibrationSet, calibration_set
from vision_robot_synth.sensor import Sensor
from vision_robot_synth.suites.suite import Plan, Suite

__all__ = ["SUITE", "calibration_figures"]

METHODS = {
    "vr": ("vr", "vr"),
    "cv2": ("subpix", "cv2"),
    "cv2-sb": ("sb", "cv2"),
    "cv2-on-vr-corners": ("vr", "cv2"),
}
"""Name -> (who finds corners, who estimates)."""

NOISE, BLUR_PX, VIEWS = (0.0, 4.0, 8.0, 16.0), (0.3, 1.0, 2.0, 3.0), (4, 8, 16)
USUAL = {"views": 12, "noise": 1.5, "blur_px": 0.5}

SCENES: dict[str, dict[str, float]] = {
    "usual": USUAL,
    **{scene_at("noise", noise): {**USUAL, "noise": noise} for noise in NOISE},
    **{scene_at("blur", blur): {**USUAL, "blur_px": blur} for blur in BLUR_PX},
    **{scene_at("views", views): {**USUAL, "views": views} for views in VIEWS},
}

CAMERA = Camera(
    640, 480, 511.2, 506.9, 328.1, 233.6, model="brown5", distortion=(-0.25, 0.09, 6e-4, -4e-4, -0.01)
)


def cells(plan: Plan) -> Sequence[Cell]:
    """Every scene by every method by every seed."""
    scenes, methods = SUITE.chosen(plan)
    return [
        Cell("calibration", scene, method, seed, f"{__name__}:calibration_figures",
             {"method": method, "seed": seed, **SCENES[scene]})
        for seed in plan.seed_range
        for scene in scenes
        for method in methods
    ]  # fmt: skip


def calibration_figures(
    workspace: Path,  # noqa: ARG001 - nothing is shared between cells
    method: str,
    seed: int,
    views: int,
    noise: float,
    blur_px: float,
) -> dict[str, float]:
    """Corner error and projection error of one method on one rendered set, and processor time."""
    made = calibration_set(CAMERA, views=views, seed=seed, sensor=Sensor(blur_px=blur_px, noise=noise))
    board = made.board
    assert isinstance(board, Chessboard), "the set's own choice"
    pictures = list(made.images())
    detector, estimator = METHODS[method]
    start = process_time()
    found = [_corners(picture, board, detector, f"view {i}") for i, picture in enumerate(pictures)]
    corners = [view for view in found if view is not None]
    if not corners:
        raise BoardNotFound(len(pictures), f"chessboard {board.size}")
    size = (made.camera.width, made.camera.height)
    if estimator == "vr":
        camera = calibrate(corners, board.points, size, Settings()).camera
    else:
        camera = opencv_camera(corners, board.points, size)
    seconds = process_time() - start
    return {
        "projection_error_px": projection_error(camera, made.camera, fit_rotation=True).rms_px,
        "corner_error_px": _corner_error(made, found),
        "boards_found": len(corners) / len(pictures),
        "cpu_s": seconds,
    }


def _corners(picture: Image, board: Chessboard, detector: str, name: str) -> Corners | None:
    if detector == "vr":
        return detect_board(picture, board, name=name)
    return opencv_corners(picture, board, detector, name=name)


def _corner_error(made: CalibrationSet, found: Sequence[Corners | None]) -> float:
    """Px rms per axis."""
    off = [view.pixels - truth[view.ids] for view, truth in zip(found, made.corners, strict=True) if view]
    return float(np.sqrt(np.mean(np.concatenate(off) ** 2)))


SUITE = Suite("calibration", tuple(SCENES), tuple(METHODS), "projection_error_px", 1.0, cells)
