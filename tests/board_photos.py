"""Photos of boards with exact truth: every pixel is the mean over its own area, no renderer needed."""

import cv2
import numpy as np

from vision_robot.calibrate.boards import Board, raster
from vision_robot.geometry import SE3, Camera, plane_from_pixels

INK, PAPER, BACKDROP = 30, 225, 120


def photo(
    board: Board,
    camera: Camera,
    cam_from_board: SE3,
    *,
    blur_px: float = 0.5,
    noise: float = 0.0,
    seed: int = 0,
    samples: int = 4,
) -> np.ndarray:
    """Grey picture of a printed board; `samples` x `samples` points are averaged in each pixel."""
    # Board positions change smoothly: bilinear between pixels they are good to 1e-4 px.
    u, v = np.meshgrid(np.arange(-1.0, camera.width + 1), np.arange(-1.0, camera.height + 1))
    plane = plane_from_pixels(camera, cam_from_board, np.stack([u, v], axis=-1))
    step = np.nanmedian(np.linalg.norm(np.diff(plane, axis=1), axis=-1))
    scale = min(2.5 / step, 3000 / max(board.size_m))
    page = raster(board.drawing(), scale)
    at_print = ((plane + board.origin_m) * scale - 0.5).astype(np.float32)
    size = (at_print.shape[1] * samples, at_print.shape[0] * samples)
    fine = cv2.resize(np.nan_to_num(at_print, nan=-1e6), size, interpolation=cv2.INTER_LINEAR)
    fine = fine[samples:-samples, samples:-samples]
    shade = INK + (PAPER - INK) / 255 * page.astype(np.float32)
    seen = cv2.remap(shade, fine[..., 0], fine[..., 1], cv2.INTER_LINEAR, borderValue=BACKDROP)
    light = cv2.resize(seen, (camera.width, camera.height), interpolation=cv2.INTER_AREA)
    if blur_px:
        light = cv2.GaussianBlur(light, (0, 0), blur_px, borderType=cv2.BORDER_REPLICATE)
    light = light + noise * np.random.default_rng(seed).standard_normal(light.shape)
    return np.clip(np.rint(light), 0, 255).astype(np.uint8)


def facing(
    board: Board, camera: Camera, *, fill: float = 0.8, tilt=(0.0, 0.0), roll: float = 0.0, aim=(0.0, 0.0)
) -> SE3:
    """A pose with the board's middle on the axis (moved by `aim` [m]), tilted about x and y, rolled [rad].

    Upright, the page takes up `fill` of the picture.
    """
    turn = SE3.from_rotvec(np.array([*tilt, 0.0]), np.zeros(3)).rotation
    turn = turn @ SE3.from_rotvec(np.array([0.0, 0.0, roll]), np.zeros(3)).rotation
    width, height = board.size_m
    distance = max(camera.fx * width / camera.width, camera.fy * height / camera.height) / fill
    middle = np.array([*(np.array(board.size_m) / 2 - board.origin_m), 0.0])
    return SE3(turn, np.array([*aim, distance]) - turn @ middle)


def truth(board: Board, camera: Camera, cam_from_board: SE3) -> np.ndarray:
    """True pixels of all board points."""
    return camera.project(cam_from_board.apply(board.points))


def rms(errors: np.ndarray) -> float:
    """Root mean square per axis."""
    return float(np.sqrt(np.mean(np.square(errors))))
