"""Trials of the hand-eye benchmark: corners and what the arm says, with the truth."""

from dataclasses import dataclass

import numpy as np
from synthetic import board_points, seen, some_camera, some_poses

from vision_robot.calibrate import Corners
from vision_robot.calibrate.boards import Chessboard
from vision_robot.calibrate.hand_eye.setup import setup_named
from vision_robot.geometry import SE3, Camera, HandEye, rotation_exp
from vision_robot.types import Array, Float
from vision_robot_synth.hand_eye import TYPICAL_ARM, hand_eye_set

BOARD = Chessboard(11, 8, 0.03)
NOISE_PX = 0.2
CELLS = (
    ("column", "eye-in-hand"),
    ("column", "eye-to-hand"),
    ("six-axis", "eye-in-hand"),
    ("six-axis", "eye-to-hand"),
    ("any pose", "eye-in-hand"),
    ("any pose", "eye-to-hand"),
)


@dataclass(frozen=True)
class Trial:
    """One draw of a cell."""

    setup: str
    corners: list[Corners]
    said: SE3
    camera: Camera
    board: Float[Array, "m 3"]
    truth: HandEye

    def error(self, mount_from_cam: SE3) -> tuple[float, float]:
        """Of the camera's position [m] and turn [rad]."""
        true = self.truth.mount_from_cam
        turn = SE3(mount_from_cam.rotation @ true.rotation.T, np.zeros(3)).rotvec()
        return float(np.linalg.norm(mount_from_cam.translation - true.translation)), float(
            np.linalg.norm(turn)
        )


def trial(arm: str, setup: str, views: int, seed: int) -> Trial:
    """A set of the cell; of `any pose` as a person would hold the board, with mountings drawn at random."""
    if arm != "any pose":
        made = hand_eye_set(setup, arm=arm, views=views, board=BOARD, seed=seed)
        cell = made.cell
        truth = HandEye(setup, made.camera, cell.mount_from_cam, cell.far_from_board, np.zeros((12, 12)))
        return Trial(setup, made.corners(NOISE_PX), made.said, made.camera, BOARD.points, truth)
    rng = np.random.default_rng([seed, 9])
    camera, board = some_camera(np.random.default_rng([seed, 4])), board_points()
    poses = some_poses(camera, views, rng)
    corners = [seen(camera, poses[i], board, rng, NOISE_PX, f"view {i}") for i in range(views)]
    mount = SE3.from_rotvec(rng.normal(size=3), rng.uniform(-0.1, 0.1, 3))
    far = SE3.from_rotvec(rng.normal(size=3), rng.uniform(-0.6, 0.6, 3))
    # mount_from_far is its own way back to base_from_wrist.
    true = setup_named(setup).mount_from_far(mount @ poses @ far.inverse())
    said = SE3(
        rotation_exp(TYPICAL_ARM.turn * rng.normal(size=(views, 3))) @ true.rotation,
        true.translation + TYPICAL_ARM.shift_m * rng.normal(size=(views, 3)),
    )
    return Trial(setup, corners, said, camera, board, HandEye(setup, camera, mount, far, np.zeros((12, 12))))
