"""Where a careful person would hold a board to calibrate a camera."""

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera, rotation_exp
from vision_robot.types import Array, Float

__all__ = ["board_poses"]

Box = tuple[float, float, float, float]

ATTEMPTS = 40
ROUNDS = 12
PER_SIDE = 8
GOLDEN = (np.sqrt(5) - 1) / 2
STEEPEST = np.deg2rad(65)
"""No point of the print is looked at under a larger angle from its normal."""


def board_poses(
    camera: Camera,
    box_m: Box,
    count: int,
    *,
    seed: int = 0,
    tilt: float = np.deg2rad(50),
    roll: float = np.deg2rad(30),
    fill: tuple[float, float] = (0.4, 0.9),
    margin: float = 0.015,
) -> SE3:
    """cam_from_board of `count` views, the same for the same seed.

    The board's print `box_m` (left, top, right, bottom in the board frame [m]) lies wholly in
    every picture, `margin` of the shorter side away from its border. Prints go to the cells
    of a 3 x 3 grid in turn and touch the margin at the picture's sides and corners, where
    they are smaller and turned less; the angle between the board's normal and the line of sight
    goes through 0 to `tilt` [rad] evenly, in all directions; `roll` [rad] about the line of
    sight is uniform to both sides; the print takes up `fill` of the picture in width or
    height. Raises BadParameter when such views cannot be found for this camera.
    """
    if count < 1:
        raise BadParameter("number of views", count, "positive")
    if not 0 <= tilt < STEEPEST:
        raise BadParameter("tilt", tilt, f"from 0 to below {STEEPEST:.3g} rad")
    rng = np.random.default_rng(seed)
    outline = _outline(box_m)
    cells = np.concatenate([rng.permutation(9) for _ in range(-(-count // 9))])[:count]
    steps = rng.permutation(count)
    poses = []
    for i in range(count):
        cell = np.array(divmod(cells[i], 3)) / 2
        cornered = np.abs(cell - 0.5).sum()  # 0 in the middle, 0.5 at a side, 1 in a corner
        # Only a small and nearly upright print brings its points close to a corner of the picture.
        near, spin = rng.uniform(0.5 - cornered / 2, 1 - cornered / 2), roll * (1 - 0.8 * cornered)
        towards = 2 * np.pi * (GOLDEN * i + 0.1 * rng.random())
        leaning = tilt * (steps[i] + rng.random()) / count
        axis = np.array([np.cos(towards), np.sin(towards), 0.0])
        turn = rotation_exp(np.array([0, 0, rng.uniform(-spin, spin)])) @ rotation_exp(leaning * axis)
        aim = np.clip(cell + rng.uniform(-0.1, 0.1, 2), 0, 1)
        poses.append(_placed(camera, outline, turn, aim, fill[0] + near * (fill[1] - fill[0]), margin))
    return SE3(np.stack([p.rotation for p in poses]), np.stack([p.translation for p in poses]))


def _outline(box_m: Box) -> Float[Array, "n 3"]:
    """Points along the border of the print, its corners included."""
    left, top, right, bottom = box_m
    s = np.linspace(0, 1, PER_SIDE, endpoint=False)
    o = np.zeros_like(s)
    x, y = np.concatenate([s, o + 1, 1 - s, o]), np.concatenate([o, s, o + 1, 1 - s])
    return np.stack([left + (right - left) * x, top + (bottom - top) * y, np.zeros_like(x)], axis=1)


def _placed(
    camera: Camera,
    outline: Float[Array, "n 3"],
    turn: Float[Array, "3 3"],
    aim: Float[Array, "2"],
    fill: float,
    margin: float,
) -> SE3:
    """The pose with this turn whose picture has the wanted place and size."""
    for _ in range(ATTEMPTS):
        pose = _settled(camera, outline, turn, aim, fill, margin)
        if pose is not None:
            return pose
        # A lens that does not see the picture's corners wants the board nearer the centre.
        aim, fill = 0.5 + 0.93 * (aim - 0.5), 0.96 * fill
    raise BadParameter(
        "camera", camera.parameters.tolist(), "one that sees the whole board, upright to a line of sight"
    )


def _settled(
    camera: Camera,
    outline: Float[Array, "n 3"],
    turn: Float[Array, "3 3"],
    aim: Float[Array, "2"],
    fill: float,
    margin: float,
) -> SE3 | None:
    """Fixed-point iteration on the centre's pixel and distance; None when it leaves the field."""
    size = np.array([camera.width, camera.height], dtype=float)
    edge = margin * size.min()
    low, high = edge - 0.5, size - 0.5 - edge
    middle = outline.mean(axis=0)
    pixel = (size - 1) / 2
    closest = _closest(np.linalg.norm(outline - middle, axis=1).max(), turn[2, 2])
    distance = 2 * closest
    pose, first, last = None, low, high
    for _ in range(ROUNDS):
        ray = camera.unproject(pixel)
        if not np.isfinite(ray).all():
            return None
        facing = _towards(ray) @ turn
        pose = SE3(facing, distance * ray - facing @ middle)
        pixels = camera.project(pose.apply(outline))
        if not np.isfinite(pixels).all():
            return None
        first, last = pixels.min(axis=0), pixels.max(axis=0)
        width = last - first
        distance = max(distance * (width / size).max() / fill, closest)
        move = low + aim * np.maximum(high - low - width, 0) - first
        if np.abs(move).max() < 0.05:
            break
        pixel = pixel + move
    inside = (first >= low - 1e-6).all() and (last <= high + 1e-6).all()
    return pose if inside else None


def _closest(radius: float, cosine: float) -> float:
    """Distance at which a disc tilted by acos(cosine) is seen under STEEPEST at its far rim.

    A rim point at q = radius / distance is seen under cos = cosine / sqrt(1 + q^2 + 2 q sine).
    """
    return radius / (cosine * np.tan(STEEPEST) - np.sqrt(1 - cosine**2))


def _towards(ray: Float[Array, "3"]) -> Float[Array, "3 3"]:
    """The smallest rotation that carries the optical axis to a unit ray."""
    x, y, z = ray
    sine = np.hypot(x, y)
    if sine < 1e-12:
        return np.eye(3)
    return rotation_exp(np.array([-y, x, 0.0]) * (np.arctan2(sine, z) / sine))
