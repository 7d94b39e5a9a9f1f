"""What the arm says less what the pictures say, and how that depends on every unknown.

In base axes, of each view: the turn ``Log(R_arm R^T)`` [rad], then the shift ``t_arm - t`` [m], where
(R, t) = ``base_from_fixed @ fixed_from_carried @ wrist_from_carried^-1``. That is where an arm errs by
its encoders and its controller, so its noise is plain here: one sigma for turns, one for shifts.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.state import HandEyeState
from vision_robot.geometry import SE3, rotation_log, skew
from vision_robot.types import Array, Float

__all__ = ["ArmRows", "arm_residuals", "arm_rows"]


@dataclass(frozen=True)
class ArmRows:
    """Residuals (turn, shift); derivatives in (w, dt) of both ends and the arm's own, and in each pose."""

    residual: Float[Array, "views 6"]
    in_shared: Float[Array, "views 6 s"]
    in_pose: Float[Array, "views 6 6"]


def arm_residuals(state: HandEyeState) -> Float[Array, "views 6"]:
    """The residuals alone."""
    said, seen = state.arm.base_from_wrist, state.base_from_wrist
    turn = rotation_log(said.rotation @ np.swapaxes(seen.rotation, -1, -2))
    return np.concatenate([turn, said.translation - seen.translation], axis=1)


def arm_rows(state: HandEyeState) -> ArmRows:
    """Residuals and derivatives."""
    residual = arm_residuals(state)
    fixed, carried_on = state.base_from_fixed, state.wrist_from_carried
    between = state.setup.fixed_from_carried(state.pictures.cam_from_board)
    wrist = fixed @ between @ carried_on.inverse()
    n = len(residual)
    eye = np.broadcast_to(np.eye(3), (n, 3, 3))
    zero = np.zeros((n, 3, 3))

    # How the wrist's pose by the pictures turns and shifts, in base axes.
    lever = skew(wrist.translation - fixed.translation)
    in_fixed = _block(eye, zero, -lever, eye)
    R = wrist.rotation
    in_carried = _block(-R, zero, -R @ skew(carried_on.translation), -R)
    # A point the wrist carries: its arm about the origin of what stands still.
    back = between.rotation @ (carried_on.inverse().translation)
    in_between = _block(fixed.rotation, zero, -fixed.rotation @ skew(back), fixed.rotation)
    in_pose = (
        in_between @ _inverse_step(state.pictures.cam_from_board)
        if state.setup.carries_camera
        else (in_between)
    )

    # d Log(R_arm R^T) of a turn of R is -Jr^-1, of a turn of R_arm Jl^-1; residuals are small.
    half = 0.5 * skew(residual[:, :3])
    right, left = _block(eye + half, zero, zero, eye), _block(eye - half, zero, zero, eye)
    shared = np.concatenate([-right @ in_fixed, -right @ in_carried, left @ state.arm.jacobian()], axis=2)
    return ArmRows(residual, shared, -right @ in_pose)


def _inverse_step(pose: SE3) -> Float[Array, "n 6 6"]:
    """How (w, dt) of a transform's inverse follow from those of the transform."""
    Rt = np.swapaxes(pose.rotation, -1, -2)
    return _block(-Rt, np.zeros_like(Rt), -Rt @ skew(pose.translation), -Rt)


def _block(a: Array, b: Array, c: Array, d: Array) -> Float[Array, "n 6 6"]:
    a, b, c, d = np.broadcast_arrays(a, b, c, d)
    return np.concatenate([np.concatenate([a, b], axis=2), np.concatenate([c, d], axis=2)], axis=1)
