"""From corners and the arm's poses to the hand-eye transform."""

from collections.abc import Sequence

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.hand_eye.board_poses import find_board_poses
from vision_robot.calibrate.hand_eye.closed_forms import CLOSED_FORMS, closed_form
from vision_robot.calibrate.hand_eye.conventions import check_joints, check_meaning
from vision_robot.calibrate.hand_eye.covariance import hand_eye_covariance
from vision_robot.calibrate.hand_eye.degeneracy import (
    FEWEST_POSES,
    LEAST_TURN,
    check_motion,
    motion_of,
    unmoved_joints,
)
from vision_robot.calibrate.hand_eye.identifiability import check_sigma
from vision_robot.calibrate.hand_eye.outliers import reason, surprise
from vision_robot.calibrate.hand_eye.pairing import check_pairing
from vision_robot.calibrate.hand_eye.pose_table import PoseTable
from vision_robot.calibrate.hand_eye.problem import ArmNoise, HandEyeProblem
from vision_robot.calibrate.hand_eye.reduced import reduced
from vision_robot.calibrate.hand_eye.result import HandEyeResult
from vision_robot.calibrate.hand_eye.settings import HandEyeSettings
from vision_robot.calibrate.hand_eye.settle import joint_problem, settle_hand_eye, start_state, with_ends
from vision_robot.calibrate.hand_eye.start import consistent_fit
from vision_robot.calibrate.hand_eye.state import HandEyeState
from vision_robot.calibrate.result import Rejected
from vision_robot.errors import BadParameter, DegeneratePoses, TooFewPoses
from vision_robot.geometry import SE3, Camera, KnownCamera, SerialChain
from vision_robot.types import Array, Bool, Float

__all__ = ["calibrate_hand_eye"]


def calibrate_hand_eye(
    corners: Sequence[Corners],
    poses: SE3 | PoseTable,
    board_points: Float[Array, "m 3"],
    camera: Camera | KnownCamera,
    settings: HandEyeSettings | None = None,
    *,
    arm: SerialChain | None = None,
    joints: Float[Array, "views n"] | None = None,
    rejected: Sequence[Rejected] = (),
) -> HandEyeResult:
    """Where a camera sits on an arm, or beside it.

    Args:
        corners: Corners of the board in each view.
        poses: base_from_wrist of the same views as the arm says it, or the table of a pose file, whose
            meaning is then checked too.
        board_points: Board points (m, 3) [m] in the board frame.
        camera: The camera's intrinsics; with their covariance they are estimated along, from there.
        settings: Which set-up, and what is estimated besides; `HandEyeSettings()` where left out.
        arm: The arm's model, for joint values.
        joints: Joint values [rad or m] of the views; with `arm` they take the place of `poses`.
        rejected: Pictures already left out, carried into the result.

    Raises:
        BadParameter: Counts that differ.
        TooFewPoses: Fewer than three usable views.
        DegeneratePoses: The motions leave something open; it is named.
        ContradictingPoses: The poses mean something else than taken for, or belong to other pictures.
        NoConvergence: The descent did not settle.
    """
    settings = settings or HandEyeSettings()
    setup = settings.arrangement
    if arm is not None and joints is not None:
        given: SE3 = arm.base_from_wrist(joints)
    else:
        given = poses.base_from_wrist if isinstance(poses, PoseTable) else poses
    if len(given) != len(corners):
        raise BadParameter(
            "number of poses", len(given), f"{len(corners)}, one for each picture with a board"
        )
    if len(corners) < FEWEST_POSES:
        raise TooFewPoses(len(corners), FEWEST_POSES, len(corners) + len(rejected))
    known_camera = camera if isinstance(camera, KnownCamera) else KnownCamera.exact(camera)
    views, usable, left_out = find_board_poses(
        corners, board_points, known_camera.camera, robust=settings.robust
    )
    if len(views) < FEWEST_POSES:
        raise TooFewPoses(
            len(views), FEWEST_POSES, len(corners) + len(rejected), "the board was seen too badly"
        )
    index = np.flatnonzero(usable)
    given = given[index]
    joints = joints[index] if joints is not None else None
    mount_from_far = setup.mount_from_far(given)
    idle = unmoved_joints(arm, joints) if arm is not None and joints is not None else ()
    table = poses.keeping(index.tolist()) if isinstance(poses, PoseTable) and joints is None else None
    try:
        check_motion(setup, mount_from_far, given=len(corners), idle=idle)
    except DegeneratePoses:
        # Angles taken for another unit look like no turn at all: the pictures know better.
        if table is not None and motion_of(views.cam_from_board).felt[0] > LEAST_TURN:
            check_meaning(table, setup, views.cam_from_board)
        raise
    if table is not None:
        fit = check_meaning(table, setup, views.cam_from_board)
    elif arm is not None and joints is not None:
        fit = check_joints(arm, joints, setup, views.cam_from_board)
    else:
        fit = consistent_fit(mount_from_far, views.cam_from_board)
    check_pairing(mount_from_far, views.cam_from_board, fit)

    everything = start_state(setup, fit, views, given, arm, joints, settings)
    problem = joint_problem(views, settings, fit, known_camera)
    end, problem, estimate, keep = settle_hand_eye(everything, problem, settings, fit)
    names = [corners[int(i)].image for i in index]
    whole = joint_problem(views, settings, fit, known_camera)
    late = _why(end.state, everything, keep, problem.noise, names, whole)
    if keep.sum() < FEWEST_POSES:
        raise TooFewPoses(int(keep.sum()), FEWEST_POSES, len(corners), "the others contradict each other")
    kept = np.flatnonzero(keep)
    motion = check_motion(
        setup, mount_from_far[kept], given=len(corners), turn_noise=estimate.noise.turn, idle=idle
    )
    left = reduced(end.state, problem)
    known = hand_eye_covariance(left.weighed(estimate.noise), estimate, setup, int(problem.free.sum()))
    check_sigma(known, setup, views.cam_from_board)
    used = views.keeping(keep)
    return HandEyeResult(
        state=end.state,
        problem=problem,
        reduced=left,
        noise=estimate,
        noise_px=views.noise_px,
        covariance=known,
        motion=motion,
        corners=tuple(corners[int(index[i])] for i in kept),
        indices=tuple(int(index[i]) for i in kept),
        rejected=(*rejected, *left_out, *late),
        closed_forms={
            name: closed_form(name)(mount_from_far[kept], used.cam_from_board) for name in CLOSED_FORMS
        },
        iterations=end.iterations,
    )


def _why(
    state: HandEyeState,
    everything: HandEyeState,
    keep: Bool[Array, "n"],
    noise: ArmNoise,
    names: Sequence[str],
    problem: HandEyeProblem,
) -> list[Rejected]:
    """The views left out, each with its reason."""
    if keep.all():
        return []
    whole = with_ends(everything, state)
    off = surprise(reduced(whole, problem), keep, noise).off
    every_pose = state.setup.mount_from_far(whole.arm.base_from_wrist)
    seen = everything.pictures.cam_from_board
    return [
        Rejected(names[int(i)], reason(int(i), state, every_pose, seen[int(i)], noise, off[i], names))
        for i in np.flatnonzero(~keep)
    ]
