"""Pictures of chessboards whose corners are known exactly, made without rendering or drawing code."""

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np

from vision_robot.calibrate.boards import Chessboard
from vision_robot.geometry import SE3, Camera

CAMERA = Camera(480, 360, 420, 418, 241.3, 176.7, 0, "brown5", (-0.25, 0.09, 5e-4, -4e-4, 0))
BOARD = Chessboard(10, 7, 0.02)
FINE = 4
"""Samples per pixel and axis, each of them smoothed over its own extent."""


@dataclass(frozen=True)
class Picture:
    """A picture and where its corners truly are."""

    grey: np.ndarray
    corners: np.ndarray


def posed(
    seed: int,
    *,
    tilt_deg: tuple[float, float] = (0, 40),
    distance_m: float = 0.3,
    board: Chessboard = BOARD,
    camera: Camera = CAMERA,
) -> SE3:
    """A random pose that shows the whole board."""
    rng = np.random.default_rng(seed)
    rim = board.square_m * np.array(
        [(x, y, 0) for x in (-1.3, board.columns + 0.3) for y in (-1.3, board.rows + 0.3)]
    )
    while True:
        axis, tilt = rng.uniform(0, 2 * np.pi), np.deg2rad(rng.uniform(*tilt_deg))
        turned = SE3.from_rotvec(np.array([0, 0, rng.uniform(-0.6, 0.6)]), np.zeros(3))
        pose = SE3.from_rotvec(tilt * np.array([np.cos(axis), np.sin(axis), 0]), np.zeros(3)) @ turned
        z = distance_m * rng.uniform(0.9, 1.1)
        centre = np.array([rng.uniform(-0.15, 0.15) * z, rng.uniform(-0.1, 0.1) * z, z])
        pose = SE3(pose.rotation, centre - pose.rotation @ board.points.mean(axis=0))
        if camera.sees(pose.apply(rim)).all():
            return pose


def picture(
    pose: SE3,
    *,
    board: Chessboard = BOARD,
    camera: Camera = CAMERA,
    blur: np.ndarray | None = None,
    light: np.ndarray | float = 1.0,
    levels: tuple[float, float] = (40, 220),
    noise: float = 0.0,
    seed: int = 0,
) -> Picture:
    """The board seen by a camera: exact projection, area sampling, then the given blur kernel.

    `blur` is a kernel on the fine grid (see `disc`); `levels` are black and white; `light` multiplies.
    """
    fine = smooth_pattern(pose, board, camera)
    if blur is not None:
        fine = cv2.filter2D(fine, -1, blur.astype(np.float32), borderType=cv2.BORDER_REPLICATE)
    grey = fine.reshape(camera.height, FINE, camera.width, FINE).mean(axis=(1, 3))
    grey = (levels[0] + (levels[1] - levels[0]) * grey) * light
    grey = grey + noise * np.random.default_rng(seed).normal(size=grey.shape)
    return Picture(np.clip(np.rint(grey), 0, 255).astype(np.uint8), camera.project(pose.apply(board.points)))


def disc(radius_px: float) -> np.ndarray:
    """Out-of-focus blur: even over a disc, unlike the Gaussian that the fit assumes."""
    reach = int(np.ceil(radius_px * FINE))
    steps = np.arange(-reach, reach + 1)
    kernel = (steps[:, None] ** 2 + steps**2 <= (radius_px * FINE) ** 2).astype(float)
    return kernel / kernel.sum()


def smooth_pattern(pose: SE3, board: Chessboard, camera: Camera) -> np.ndarray:
    """White 1, black 0 on the fine grid; grey beyond the paper."""
    x, y = rays(camera)
    R, t = pose.rotation, pose.translation
    depth = (R[:, 2] @ t) / (R[0, 2] * x + R[1, 2] * y + R[2, 2])
    ray = (x * depth - t[0], y * depth - t[1], depth - t[2])
    a, b = (np.asarray(np.tensordot(R[:, axis], np.stack(ray), 1)) / board.square_m for axis in range(2))
    steps = [np.linalg.norm(np.gradient(c), axis=0) for c in (a, b)]

    def edge(c: np.ndarray, step: np.ndarray) -> np.ndarray:
        """+1 and -1 in turn between whole numbers, straight over a sample's extent at each."""
        whole = np.round(c)
        return np.clip(2 * (c - whole) / step, -1, 1) * np.where(whole % 2 == 0, 1, -1)

    def within(c: np.ndarray, step: np.ndarray, low: float, high: float) -> np.ndarray:
        return np.clip((c - low) / step + 0.5, 0, 1) * np.clip((high - c) / step + 0.5, 0, 1)

    black = 0.5 + 0.5 * edge(a, steps[0]) * edge(b, steps[1])
    black *= within(a, steps[0], -1, board.columns) * within(b, steps[1], -1, board.rows)
    paper = within(a, steps[0], -2, board.columns + 1) * within(b, steps[1], -2, board.rows + 1)
    return (0.4 + (0.6 - black) * paper).astype(np.float32)


@cache
def rays(camera: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Slopes x/z and y/z of the rays of the fine grid: Brown's model inverted by iteration."""
    u = (np.arange(camera.width * FINE, dtype=np.float32) + 0.5) / FINE - 0.5
    v = (np.arange(camera.height * FINE, dtype=np.float32) + 0.5) / FINE - 0.5
    x, y = np.meshgrid((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy)
    k1, k2, p1, p2, k3 = camera.distortion
    a, b = x.copy(), y.copy()
    for _ in range(8):
        r = a * a + b * b
        radial = 1 + r * (k1 + r * (k2 + r * k3))
        a, b = (
            (x - 2 * p1 * a * b - p2 * (r + 2 * a * a)) / radial,
            (y - p1 * (r + 2 * b * b) - 2 * p2 * a * b) / radial,
        )
    return a, b
