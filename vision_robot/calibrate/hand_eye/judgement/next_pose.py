"""The next best pose: where to drive the arm so that the camera's place is known best afterwards.

A view adds ``H^T V^-1 H`` to the information whatever its picture will show, so its gain can be computed
before it is taken: the covariance falls to ``C - C H^T (V + H C H^T)^-1 H C``. What counts is where a
point before the camera lands in the frame the camera is mounted on, ``tr(J C J^T)``: A-optimal design.
"""

from dataclasses import dataclass, replace

import numpy as np

from vision_robot.calibrate.hand_eye.arm import ArmGeometry, GivenPoses
from vision_robot.calibrate.hand_eye.judgement.candidate_poses import CandidatePoses, candidate_poses
from vision_robot.calibrate.hand_eye.judgement.error_budget import point_jacobian, working_point
from vision_robot.calibrate.hand_eye.reduced import reduced
from vision_robot.calibrate.hand_eye.result import HandEyeResult
from vision_robot.calibrate.hand_eye.state import HandEyeState
from vision_robot.calibrate.hand_eye.words import degrees, direction
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.state import State
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, SerialChain
from vision_robot.types import Array, Float

__all__ = ["NextPoses", "next_poses"]

APART = np.radians(15)
APART_M = 0.05
"""Proposed poses differ from each other by at least so much in turn or in place."""


@dataclass(frozen=True)
class NextPoses:
    """Poses that help most, best first, each the best beside all those before it.

    `sigma_m` is the error of a point before the camera as it is, root mean square; `together_m` (k,) with
    this pose and all before it. `joints` (k, n) where the arm's model is known.
    """

    base_from_wrist: SE3
    joints: Float[Array, "k n"] | None
    words: tuple[str, ...]
    sigma_m: float
    alone_m: Float[Array, "k"]
    together_m: Float[Array, "k"]

    def __len__(self) -> int:
        return len(self.words)


def next_poses(
    result: HandEyeResult,
    *,
    arm: SerialChain | None = None,
    count: int = 3,
    seed: int = 0,
    candidates: CandidatePoses | None = None,
) -> NextPoses:
    """The `count` next poses that lower the error of a point before the camera most.

    Args:
        result: The calibration so far.
        arm: The arm's model, whose limits are kept; without it poses like those so far are proposed.
        count: How many poses, different from each other.
        seed: Of the candidates that are drawn.
        candidates: The poses to choose from, where they are given.

    Raises:
        BadParameter: `count` is not positive, or no pose shows the whole board.
    """
    if count < 1:
        raise BadParameter("number of next poses", count, "positive")
    if arm is None and result.geometry is not None:
        arm = result.geometry.chain
    candidates = candidates or candidate_poses(result, arm, seed=seed)
    if not len(candidates):
        allowed = "one in which the arm's limits let the camera see the whole board"
        raise BadParameter("next pose", "none found", allowed)
    H, V = _information(result, candidates)
    C = result.reduced.weighed(result.noise.noise).covariance
    J = np.zeros((3, len(C)))
    first = int(result.problem.free.sum()) + (6 if result.setup.carries_camera else 0)
    J[:, first : first + 6] = point_jacobian(result, working_point(result))
    before = float(np.sqrt(np.trace(J @ C @ J.T)))
    start = _after(C, H, V, J)
    chosen: list[int] = []
    together: list[float] = []
    open_to_choice = np.ones(len(candidates), dtype=bool)
    while len(chosen) < count and open_to_choice.any():
        after = _after(C, H, V, J) if chosen else start
        best = int(np.argmin(np.where(open_to_choice, after, np.inf)))
        chosen.append(best)
        together.append(float(after[best]))
        gain = C @ H[best].T
        C = C - gain @ np.linalg.solve(V[best] + H[best] @ gain, gain.T)
        motion = candidates.base_from_wrist[best].inverse() @ candidates.base_from_wrist
        near = np.linalg.norm(motion.rotvec(), axis=1) < APART
        open_to_choice &= ~(near & (np.linalg.norm(motion.translation, axis=1) < APART_M))
    index = np.array(chosen)
    return NextPoses(
        base_from_wrist=candidates.base_from_wrist[index],
        joints=None if candidates.joints is None else candidates.joints[index],
        words=tuple(_words(candidates.base_from_wrist[i], result.base_from_wrist) for i in chosen),
        sigma_m=before,
        alone_m=start[index],
        together_m=np.array(together),
    )


def _information(
    result: HandEyeResult, candidates: CandidatePoses
) -> tuple[Float[Array, "k 6 s"], Float[Array, "k 6 6"]]:
    """Design and covariance of each candidate, with corners as sure as now."""
    now, seen = result.state, result.problem.pictures.seen
    k, n = len(candidates), candidates.pixels.shape[1]
    arm = now.arm
    if isinstance(arm, ArmGeometry) and candidates.joints is not None:
        arm = ArmGeometry(arm.chain, candidates.joints, arm.basis, arm.values, arm.nominal, arm.tolerance)
    else:
        arm = GivenPoses(candidates.base_from_wrist)
    pictures = State(now.pictures.camera, candidates.cam_from_board, now.pictures.warp)
    state = HandEyeState(now.setup, now.base_from_fixed, now.wrist_from_carried, pictures, arm)
    weight = float(np.median(seen.weight[seen.present]))
    views = Observations(
        points=np.broadcast_to(candidates.points.T, (k, 3, n)),
        pixels=np.swapaxes(candidates.pixels, 1, 2),
        weight=np.full((k, n), weight),
        ids=np.broadcast_to(np.arange(n), (k, n)),
        sigma_px=np.full((k, n), 1 / weight),
    )
    asked = reduced(state, replace(result.problem, pictures=result.problem.pictures.of(views)))
    return asked.design, asked.by_pictures + np.diag(np.repeat(result.noise.noise.variances, 3))


def _after(C: Array, H: Array, V: Array, J: Array) -> Float[Array, "k"]:
    """Error of the point [m] with each candidate added alone."""
    gain = C @ np.swapaxes(H, 1, 2)  # k, s, 6
    moved = J @ gain
    solved = np.linalg.solve(V + H @ gain, np.swapaxes(moved, 1, 2))
    less = np.einsum("kij,kji->k", moved, solved)
    return np.sqrt(np.maximum(np.trace(J @ C @ J.T) - less, 0.0))


def _words(pose: SE3, so_far: SE3) -> str:
    """Where to drive, for a person at the arm's panel."""
    motion = so_far.inverse() @ pose
    turns = np.linalg.norm(motion.rotvec(), axis=1)
    nearest = int(np.argmin(turns))
    x, y, z = 1e3 * pose.translation
    place = f"drive the wrist to x {x:.0f}, y {y:.0f}, z {z:.0f} mm"
    if turns[nearest] < np.radians(5):
        return f"{place}, turned as in view {nearest + 1}"
    about = direction(motion.rotvec()[nearest] / turns[nearest], "wrist")
    return f"{place}, turned {degrees(float(turns[nearest]))} from view {nearest + 1} about {about}"
