"""K. Daniilidis, "Hand-eye calibration using dual quaternions", IJRR 18(3), 1999."""

import numpy as np

from vision_robot.calibrate.hand_eye.closed_forms.translation import mean_pose
from vision_robot.calibrate.hand_eye.motions import motions
from vision_robot.geometry import SE3, rotation_exp, skew
from vision_robot.types import Array, Float

__all__ = ["solve"]


def solve(mount_from_far: SE3, cam_from_board: SE3) -> tuple[SE3, SE3]:
    """Rotation and translation together: a unit dual quaternion in the null space of all screws (eq. 31)."""
    pairs = motions(mount_from_far, cam_from_board).have_axes
    (q_a, d_a), (q_b, d_b) = _dual(pairs.a), _dual(pairs.b)
    rows = np.zeros((len(pairs), 6, 8))
    rows[:, :3, 0], rows[:, :3, 1:4] = q_a - q_b, skew(q_a + q_b)
    rows[:, 3:, 0], rows[:, 3:, 1:4] = d_a - d_b, skew(d_a + d_b)
    rows[:, 3:, 4:] = rows[:, :3, :4]
    # The two smallest right singular vectors span the solution (section 6).
    rows = rows.reshape(-1, 8)
    v7, v8 = np.linalg.eigh(rows.T @ rows)[1][:, :2].T
    u1, w1, u2, w2 = v7[:4], v7[4:], v8[:4], v8[4:]
    s = _scale_ratio(u1 @ w1, u1 @ w2 + u2 @ w1, u2 @ w2, u1, u2)
    length = s * s * (u1 @ u1) + 2 * s * (u1 @ u2) + u2 @ u2  # eq. 34 and 35: unit quaternion
    q, d = (s * u1 + u2) / np.sqrt(length), (s * w1 + w2) / np.sqrt(length)
    rotation = _rotation(q)
    translation = 2 * (q[0] * d[1:] - d[0] * q[1:] + np.cross(q[1:], d[1:]))  # 2 d q*
    mount_from_cam = SE3(rotation, translation)
    return mount_from_cam, mean_pose(mount_from_far.inverse() @ mount_from_cam @ cam_from_board)


def _dual(motion: SE3) -> tuple[Float[Array, "m 3"], Float[Array, "m 3"]]:
    """Vector parts of the dual quaternion q + epsilon t q / 2; the scalar parts are the same for a and b."""
    turn = motion.rotvec()
    half = np.linalg.norm(turn, axis=1, keepdims=True) / 2
    vector = np.sinc(half / np.pi) * turn / 2
    t = motion.translation
    return vector, (np.cos(half) * t + np.cross(t, vector)) / 2


def _scale_ratio(a: float, b: float, c: float, u1: Array, u2: Array) -> float:
    """The root of ``a s^2 + b s + c`` whose quaternion is the longer (eq. 33)."""
    if abs(a) < 1e-15:
        return -c / b if abs(b) > 1e-15 else 0.0
    root = np.sqrt(max(b * b - 4 * a * c, 0.0))
    roots = [(-b + root) / (2 * a), (-b - root) / (2 * a)]
    return max(roots, key=lambda s: s * s * (u1 @ u1) + 2 * s * (u1 @ u2) + u2 @ u2)


def _rotation(q: Float[Array, "4"]) -> Float[Array, "3 3"]:
    sine = np.linalg.norm(q[1:])
    angle = 2 * np.arctan2(sine, q[0])
    return rotation_exp(q[1:] * (angle / sine if sine > 1e-12 else 2.0))
