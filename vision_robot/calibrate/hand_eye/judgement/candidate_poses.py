"""Poses the arm could take with the whole board before the camera."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.result import HandEyeResult
from vision_robot.calibrate.hand_eye.visibility import whole_board_seen
from vision_robot.geometry import SE3, SerialChain, rotation_exp
from vision_robot.types import Array, Float

__all__ = ["CandidatePoses", "candidate_poses"]

DRAWN = 6000
KEPT = 400
WIDER = 0.15
"""Metres past the places so far that the wrist is allowed, where its limits are not known."""


@dataclass(frozen=True)
class CandidatePoses:
    """Poses of the wrist, what the camera would see of the board there, and joint values where known."""

    base_from_wrist: SE3
    cam_from_board: SE3
    pixels: Float[Array, "k n 2"]
    points: Float[Array, "n 3"]
    joints: Float[Array, "k j"] | None = None

    def __len__(self) -> int:
        return len(self.pixels)


def candidate_poses(result: HandEyeResult, arm: SerialChain | None, *, seed: int = 0) -> CandidatePoses:
    """Draw joint values within the limits, or poses about those so far, and keep where the board is seen."""
    rng = np.random.default_rng([seed, 17])
    joints = None
    if arm is not None:
        joints = rng.uniform(arm.limits[:, 0], arm.limits[:, 1], (DRAWN, len(arm)))
        poses = arm.base_from_wrist(joints)
    else:
        poses = _about(result, rng)
    points = _board_points(result)
    X, Z = result.mount_from_cam, result.far_from_board
    cam_from_board = X.inverse() @ result.setup.mount_from_far(poses) @ Z
    pixels, seen = whole_board_seen(result.camera, cam_from_board, points)
    some = np.flatnonzero(seen)[:KEPT]
    return CandidatePoses(
        poses[some], cam_from_board[some], pixels[some], points, None if joints is None else joints[some]
    )


def _about(result: HandEyeResult, rng: np.random.Generator) -> SE3:
    """Poses so far, turned by up to 45 degrees about the board's middle and moved a little."""
    setup, k = result.setup, DRAWN
    old = rng.integers(0, len(result.names), k)
    middle = _board_points(result).mean(axis=0)
    cam_from_board = result.cam_from_board[old]
    centre = cam_from_board.apply(np.broadcast_to(middle, (k, 1, 3)))[:, 0]
    turn = rotation_exp(rng.normal(size=(k, 3)) * np.radians(30))
    rotation = turn @ cam_from_board.rotation
    where = centre * rng.uniform(0.8, 1.25, (k, 1)) + 0.05 * np.linalg.norm(centre, axis=1)[
        :, None
    ] * rng.normal(size=(k, 3))
    moved = SE3(rotation, where - rotation @ middle)
    mount_from_far = result.mount_from_cam @ moved @ result.far_from_board.inverse()
    base_from_wrist = setup.mount_from_far(mount_from_far)
    place, used = base_from_wrist.translation, result.base_from_wrist.translation
    inside = ((place > used.min(axis=0) - WIDER) & (place < used.max(axis=0) + WIDER)).all(axis=1)
    # A wrist leans no farther from its usual direction than it has leant so far, and a little more.
    mean = result.base_from_wrist.rotation[..., 2].mean(axis=0)
    mean = mean / max(np.linalg.norm(mean), 1e-9)
    leant = np.arccos(np.clip(result.base_from_wrist.rotation[..., 2] @ mean, -1, 1)).max()
    leans = np.arccos(np.clip(base_from_wrist.rotation[..., 2] @ mean, -1, 1))
    return base_from_wrist[inside & (leans < leant + np.radians(15))]


def _board_points(result: HandEyeResult) -> Float[Array, "n 3"]:
    """All board points that any view holds, by id."""
    seen = result.problem.pictures.seen
    ids, points = seen.ids[seen.present], np.swapaxes(seen.points, 1, 2)[seen.present]
    _, first = np.unique(ids, return_index=True)
    return points[first]
