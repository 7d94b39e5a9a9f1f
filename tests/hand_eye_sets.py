"""Hand-eye sets with exact truth, made without rendering."""

from dataclasses import dataclass

import numpy as np

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Corners
from vision_robot.calibrate.hand_eye.setup import setup_named
from vision_robot.geometry import SE3, Camera, HandEye, rotation_exp

TURN, SHIFT_M = np.radians(0.02), 0.3e-3


@dataclass(frozen=True)
class Posed:
    """Corners, what the arm says, where it was, and the mountings."""

    setup: str
    camera: Camera
    board: np.ndarray
    corners: list[Corners]
    cam_from_board: SE3
    said: SE3
    base_from_wrist: SE3
    truth: HandEye


def posed(
    setup: str = "eye-in-hand",
    count: int = 15,
    *,
    seed: int = 0,
    noise_px: float = 0.2,
    turn: float = TURN,
    shift_m: float = SHIFT_M,
) -> Posed:
    """Views with the board anywhere before the camera; mountings drawn at random."""
    views = make_views(CAMERAS["brown5"], count, seed=seed, noise_px=noise_px, tilt=0.5)
    rng = np.random.default_rng([seed, 2])
    mount = SE3.from_rotvec(rng.normal(size=3), rng.uniform(-0.1, 0.1, 3))
    far = SE3.from_rotvec(rng.normal(size=3), rng.uniform(-0.6, 0.6, 3))
    true = setup_named(setup).mount_from_far(mount @ views.cam_from_board @ far.inverse())
    said = SE3(
        rotation_exp(turn * rng.normal(size=(count, 3))) @ true.rotation,
        true.translation + shift_m * rng.normal(size=(count, 3)),
    )
    truth = HandEye(setup, views.camera, mount, far, np.zeros((12, 12)))
    return Posed(setup, views.camera, views.board, views.corners, views.cam_from_board, said, true, truth)
