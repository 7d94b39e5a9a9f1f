"""Motions between views: what the arm did and what the camera saw of it, pair by pair.

With ``cam_from_board_i = mount_from_cam^-1 @ mount_from_far_i @ far_from_board`` the motion of the
arm ``A = mount_from_far_i @ mount_from_far_j^-1`` and that of the pictures
``B = cam_from_board_i @ cam_from_board_j^-1`` are one and the same seen from two frames:
``A X = X B`` with X = mount_from_cam (Shiu & Ahmad 1989). Two numbers of a motion do not depend on
the frame, the angle and the shift along its axis (Chen 1991), so they can be compared before X is known.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.geometry import SE3
from vision_robot.types import Array, Bool, Float, Int

__all__ = ["HALF_TURN", "Motions", "motions"]

ALL_PAIRS_UP_TO = 160
"""Views up to which every pair is taken; larger sets take each view with so many others."""

HALF_TURN = np.radians(170)
"""From here noise may turn the sign of a motion's axis, which closed forms on rotation vectors rely on."""

TURNS = np.radians(2)
"""Below this angle a motion's axis, and its shift along it, is noise."""


@dataclass(frozen=True)
class Motions:
    """Pairs (first, second) of views with the arm's motion `a` and the pictures' motion `b`."""

    first: Int[Array, "m"]
    second: Int[Array, "m"]
    a: SE3
    b: SE3

    def __len__(self) -> int:
        return len(self.first)

    def keeping(self, mask: Bool[Array, "m"]) -> "Motions":
        """The pairs under the mask."""
        return Motions(self.first[mask], self.second[mask], self.a[mask], self.b[mask])

    @property
    def turned_a(self) -> Float[Array, "m 3"]:
        """Rotation vectors of the arm's motions [rad]."""
        return self.a.rotvec()

    @property
    def turned_b(self) -> Float[Array, "m 3"]:
        """Rotation vectors of the pictures' motions [rad]."""
        return self.b.rotvec()

    @property
    def have_axes(self) -> "Motions":
        """Those short of half a turn."""
        angle = np.maximum(*(np.linalg.norm(v, axis=1) for v in (self.turned_a, self.turned_b)))
        return self.keeping(angle < HALF_TURN)

    def disagreement(self) -> tuple[Float[Array, "m"], Float[Array, "m"]]:
        """Difference of angles [rad] and of shifts along the axis [m]; the shift is NaN without a turn."""
        angle_a, shift_a = _screw(self.a)
        angle_b, shift_b = _screw(self.b)
        with np.errstate(invalid="ignore"):
            return np.abs(angle_a - angle_b), np.abs(np.abs(shift_a) - np.abs(shift_b))


def motions(mount_from_far: SE3, cam_from_board: SE3) -> Motions:
    """All pairs of views, or for large sets each view with the same number of others."""
    n = len(cam_from_board)
    if n <= ALL_PAIRS_UP_TO:
        first, second = np.triu_indices(n, 1)
    else:
        steps = np.unique(np.geomspace(1, n // 2, ALL_PAIRS_UP_TO // 2).astype(int))
        first = np.tile(np.arange(n), len(steps))
        second = (first + np.repeat(steps, n)) % n
    far_from_mount, board_from_cam = mount_from_far.inverse(), cam_from_board.inverse()
    a = mount_from_far[first] @ far_from_mount[second]
    b = cam_from_board[first] @ board_from_cam[second]
    return Motions(first, second, a, b)


def _screw(motion: SE3) -> tuple[Float[Array, "m"], Float[Array, "m"]]:
    """Angle and shift along the axis."""
    turn = motion.rotvec()
    angle = np.linalg.norm(turn, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        axis = np.where(angle[:, None] > TURNS, turn / angle[:, None], np.nan)
    return angle, (axis * motion.translation).sum(axis=1)
