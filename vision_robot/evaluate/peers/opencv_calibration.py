"""OpenCV's corners and OpenCV's calibration, as a person would call them."""

from collections.abc import Sequence

import cv2
import numpy as np

from vision_robot.calibrate import Corners
from vision_robot.calibrate.boards import Chessboard
from vision_robot.calibrate.boards.chessboard_order import canonical_grid
from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera
from vision_robot.types import Array, Float, Image

__all__ = ["opencv_camera", "opencv_corners"]

WINDOW_PX = 5
STOP = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 40, 0.001)
MODELS = {"pinhole": 0, "brown5": 5, "brown8": 8}


def opencv_corners(image: Image, board: Chessboard, method: str, *, name: str = "") -> Corners | None:
    """Corners by `method`: "subpix" (findChessboardCorners and cornerSubPix) or "sb"; None where not seen.

    In the order of our board, which OpenCV's two detectors do not keep.
    """
    size = (board.columns, board.rows)
    if method == "sb":
        flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_ACCURACY | cv2.CALIB_CB_EXHAUSTIVE
        found, pixels = cv2.findChessboardCornersSB(image, size, flags=flags)
    elif method == "subpix":
        found, pixels = cv2.findChessboardCorners(image, size)
        if found:
            points = np.asarray(pixels, dtype=np.float32).reshape(-1, 1, 2)
            pixels = cv2.cornerSubPix(image, points, (WINDOW_PX, WINDOW_PX), (-1, -1), STOP)
    else:
        raise BadParameter("corner method", method, "subpix or sb")
    if not found:
        return None
    grid = np.asarray(pixels, dtype=float).reshape(board.rows, board.columns, 2)
    ordered = canonical_grid(image, grid, size).reshape(-1, 2)
    return Corners(name, np.arange(len(ordered)), ordered)


def opencv_camera(
    corners: Sequence[Corners], points: Float[Array, "n 3"], size: tuple[int, int], model: str = "brown5"
) -> Camera:
    """``cv2.calibrateCamera`` on corners."""
    if model not in MODELS:
        raise BadParameter("model", model, f"one of {', '.join(MODELS)}")
    on_board = [points[view.ids].astype(np.float32) for view in corners]
    seen = [view.pixels.astype(np.float32) for view in corners]
    flags = cv2.CALIB_RATIONAL_MODEL if model == "brown8" else 0
    if model == "pinhole":
        flags = cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3 | cv2.CALIB_ZERO_TANGENT_DIST
    _, K, distortion, _, _ = cv2.calibrateCamera(on_board, seen, size, None, None, flags=flags)  # type: ignore[call-overload]
    coefficients = tuple(np.ravel(distortion)[: MODELS[model]].tolist())
    return Camera(*size, K[0, 0], K[1, 1], K[0, 2], K[1, 2], 0.0, model, coefficients)
