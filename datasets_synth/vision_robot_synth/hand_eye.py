"""The synthetic hand-eye set: a board photographed in MuJoCo from an arm, every truth known."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from vision_robot.calibrate import Corners
from vision_robot.calibrate.boards import Board, Chessboard
from vision_robot.calibrate.hand_eye import ArmNoise
from vision_robot.calibrate.hand_eye.setup import setup_named
from vision_robot.calibrate.hand_eye.visibility import whole_board_seen
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera, SerialChain, rotation_exp
from vision_robot.sim.board_scene import render_views
from vision_robot.types import Array, Float, Image
from vision_robot_synth.calibration import TRUTH, board_print
from vision_robot_synth.hand_eye_arms import HandEyeCell, cell_named, with_link_errors
from vision_robot_synth.sensor import Sensor

__all__ = ["TYPICAL_ARM", "HandEyeSet", "hand_eye_set"]

TYPICAL_ARM = ArmNoise(np.radians(0.02), 0.3e-3)
"""Per axis: what a good industrial arm's pose is off by once its own geometry is calibrated."""

DRAWN, MOST_DRAWS = 4000, 60

SMALLEST = 0.3
"""Least part of the picture's width or height that a careful person lets the board take up."""


@dataclass(frozen=True)
class HandEyeSet:
    """An arm that takes pictures of a board, or shows it to a camera: truth, and what the arm says.

    The arm says where its nominal links and its joint values put the wrist; where the wrist is, its true
    links say, and noise of its own for every view. Pictures are rendered when asked for.
    """

    setup: str
    cell: HandEyeCell
    true_arm: SerialChain
    joints: Float[Array, "views n"]
    camera: Camera
    board: Board
    noise: ArmNoise
    seed: int
    sensor: Sensor = field(default_factory=Sensor)

    def __len__(self) -> int:
        return len(self.joints)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the views."""
        return tuple(f"view {i:02d}" for i in range(len(self)))

    @property
    def said(self) -> SE3:
        """base_from_wrist as the arm's controller says it."""
        return self.cell.arm.base_from_wrist(self.joints)

    @property
    def base_from_wrist(self) -> SE3:
        """Where the wrist truly was."""
        drawn = [np.random.default_rng([self.seed, 5, i]).normal(size=6) for i in range(len(self))]
        off = np.array(drawn).reshape(-1, 6)
        pose = self.true_arm.base_from_wrist(self.joints)
        return SE3(
            rotation_exp(self.noise.turn * off[:, :3]) @ pose.rotation,
            pose.translation + self.noise.shift_m * off[:, 3:],
        )

    @property
    def cam_from_board(self) -> SE3:
        """Where the board truly was before the camera."""
        mount_from_far = setup_named(self.setup).mount_from_far(self.base_from_wrist)
        return self.cell.mount_from_cam.inverse() @ mount_from_far @ self.cell.far_from_board

    def driven_to(self, joints: Float[Array, "n"]) -> "HandEyeSet":
        """The same with one view more, from these joint values."""
        return replace(self, joints=np.concatenate([self.joints, joints[None]]))

    def corners(self, noise_px: float) -> list[Corners]:
        """What a detector with Gaussian noise would report, without rendering."""
        pixels = self.camera.project(self.cam_from_board.apply(self.board.points))
        found = []
        for i, (name, seen) in enumerate(zip(self.names, pixels, strict=True)):
            ids = np.flatnonzero(np.isfinite(seen[:, 0]))
            noise = np.random.default_rng([self.seed, 6, i]).normal(size=(len(ids), 2))
            found.append(Corners(name, ids, seen[ids] + noise_px * noise))
        return found

    def images(self, views: Sequence[int] | None = None) -> Iterator[Image]:
        """The grey pictures of some views (all where left out), the same at every call."""
        wanted = np.arange(len(self)) if views is None else np.asarray(views, dtype=int)
        if not len(wanted):
            return
        multisamples = 4 if self.camera.model == "pinhole" and self.camera.skew == 0 else 0
        poses = self.cam_from_board[wanted]
        clean = render_views(board_print(self.board), self.camera, poses, multisamples=multisamples)
        for view, image in zip(wanted, clean, strict=True):
            yield self.sensor.expose(image, np.random.default_rng([self.seed, 7, int(view)]))


def hand_eye_set(
    setup: str = "eye-in-hand",
    *,
    arm: str = "column",
    views: int = 15,
    board: Board | None = None,
    noise: ArmNoise = TYPICAL_ARM,
    link_errors: tuple[float, float] = (0.0, 0.0),
    seed: int = 0,
) -> HandEyeSet:
    """Poses within the arm's limits from which the camera sees the whole board, drawn by chance.

    Args:
        setup: eye-in-hand or eye-to-hand.
        arm: column (the project's own) or six-axis.
        views: How many.
        board: The target; a chessboard of 9 x 6 inner corners with 25 mm squares where left out.
        noise: Of the wrist's pose, per axis, drawn anew for every view.
        link_errors: How far each true link is from the nominal one, turn [rad] and shift [m].
        seed: The same seed gives the same set.

    Raises:
        BadParameter: No such cell, a negative seed, no views, or no pose that shows the board.
    """
    if seed < 0:
        raise BadParameter("seed", seed, "zero or a positive whole number")
    if views < 1:
        raise BadParameter("number of views", views, "positive")
    cell = cell_named(arm, setup)
    board = board or Chessboard(9, 6, 0.025)
    rng = np.random.default_rng([seed, 4])
    true_arm = with_link_errors(cell.arm, *link_errors, rng) if any(link_errors) else cell.arm
    made = HandEyeSet(setup, cell, true_arm, np.zeros((0, len(cell.arm))), TRUTH, board, noise, seed)
    outline = _outline(board)
    found: list[Array] = []
    for _ in range(MOST_DRAWS):
        joints = rng.uniform(cell.arm.limits[:, 0], cell.arm.limits[:, 1], (DRAWN, len(cell.arm)))
        mount_from_far = setup_named(setup).mount_from_far(true_arm.base_from_wrist(joints))
        pose = cell.mount_from_cam.inverse() @ mount_from_far @ cell.far_from_board
        seen = whole_board_seen(TRUTH, pose, outline, smallest=SMALLEST)[1]
        found.append(joints[seen])
        if sum(map(len, found)) >= views:
            return replace(made, joints=np.concatenate(found)[:views])
    raise BadParameter("synthetic set", f"{arm}, {setup}", "a cell in which the camera sees the whole board")


def _outline(board: Board) -> Float[Array, "n 3"]:
    """The border of the print."""
    left, top, right, bottom = board_print(board).box_m
    s = np.linspace(0, 1, 9)
    o = np.zeros_like(s)
    x, y = np.concatenate([s, s, o, o + 1]), np.concatenate([o, o + 1, s, s])
    return np.stack([left + (right - left) * x, top + (bottom - top) * y, 0 * x], axis=1)
