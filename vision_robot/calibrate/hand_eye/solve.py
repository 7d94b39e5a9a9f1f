"""From corners and the arm's poses to the hand-eye transform."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.hand_eye.arm import ArmGeometry, GivenPoses
from vision_robot.calibrate.hand_eye.arm_noise import (
    LEAST,
    NoiseEstimate,
    component_information,
    estimate_noise,
)
from vision_robot.calibrate.hand_eye.board_poses import BoardViews, find_board_poses
from vision_robot.calibrate.hand_eye.closed_forms import CLOSED_FORMS, closed_form
from vision_robot.calibrate.hand_eye.conventions import check_meaning
from vision_robot.calibrate.hand_eye.covariance import hand_eye_covariance
from vision_robot.calibrate.hand_eye.degeneracy import (
    FEWEST_POSES,
    LEAST_TURN,
    check_motion,
    motion_of,
    unmoved_joints,
)
from vision_robot.calibrate.hand_eye.identifiability import check_sigma
from vision_robot.calibrate.hand_eye.outliers import explained_views, reason, surprise
from vision_robot.calibrate.hand_eye.pairing import check_pairing
from vision_robot.calibrate.hand_eye.pose_table import PoseTable
from vision_robot.calibrate.hand_eye.problem import ArmNoise, HandEyeProblem
from vision_robot.calibrate.hand_eye.reduced import Reduced, reduced
from vision_robot.calibrate.hand_eye.refine import HandEyeEnd, refine_hand_eye
from vision_robot.calibrate.hand_eye.result import HandEyeResult
from vision_robot.calibrate.hand_eye.settings import HandEyeSettings
from vision_robot.calibrate.hand_eye.setup import Setup
from vision_robot.calibrate.hand_eye.start import Fit, consistent_fit
from vision_robot.calibrate.hand_eye.state import HandEyeState
from vision_robot.calibrate.result import Rejected
from vision_robot.calibrate.state import State
from vision_robot.errors import BadParameter, DegeneratePoses, NoConvergence, TooFewPoses
from vision_robot.geometry import SE3, Camera, KnownCamera, SerialChain
from vision_robot.types import Array, Bool, Float

__all__ = ["calibrate_hand_eye"]

NOISE_SETTLED = 0.02
ROUNDS = 8


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
    else:
        fit = consistent_fit(mount_from_far, views.cam_from_board)
    check_pairing(mount_from_far, views.cam_from_board, fit)

    everything = _start(setup, fit, views, given, arm, joints, settings)
    problem = _problem(views, settings, fit, known_camera)
    end, problem, estimate, keep = _settled(everything, problem, settings, fit)
    names = [corners[int(i)].image for i in index]
    late = _why(
        end.state,
        everything,
        keep,
        problem.noise,
        names,
        problem=_problem(views, settings, fit, known_camera),
    )
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


def _start(
    setup: Setup,
    fit: Fit,
    views: BoardViews,
    given: SE3,
    arm: SerialChain | None,
    joints: Array | None,
    settings: HandEyeSettings,
) -> HandEyeState:
    """All views at the closed form's answer."""
    fixed, carried = setup.fixed_and_carried(fit.mount_from_cam, fit.far_from_board)
    own: GivenPoses | ArmGeometry = GivenPoses(given)
    if settings.geometry is not None:
        if arm is None or joints is None:
            raise BadParameter(
                "arm geometry", "asked for", "left out where no arm model and joint values are given"
            )
        own = ArmGeometry.of(arm, joints, settings.geometry)
    return HandEyeState(setup, fixed, carried, views.state, own)


def _problem(views: BoardViews, settings: HandEyeSettings, fit: Fit, camera: KnownCamera) -> HandEyeProblem:
    turn, shift = (float(np.median(part)) / 1.54 for part in (fit.turn, fit.shift_m))
    noise = settings.noise or ArmNoise(max(turn, LEAST.turn), max(shift, LEAST.shift_m))
    spread = _little_known(camera.camera) if settings.free_camera else camera.covariance
    free: Array = np.diag(spread) > 0
    if not free.any():
        return HandEyeProblem(views.problem, noise)
    freed, mean = views.problem.freeing(free), camera.camera.parameters
    return HandEyeProblem(freed, noise, mean, _information(spread, free))


def _little_known(camera: Camera) -> Float[Array, "p p"]:
    """Covariance that keeps what the views do not tell near its value; the skew is held."""
    size = float(np.hypot(camera.width, camera.height))
    affine = [0.1 * camera.fx, 0.1 * camera.fy, 0.1 * size, 0.1 * size, 0.0]
    return np.diag(np.square(affine + [1.0] * len(camera.distortion)))


def _information(covariance: Float[Array, "p p"], free: Bool[Array, "p"]) -> Float[Array, "p p"]:
    """Inverse over the free parameters, which span eight orders of magnitude; zero elsewhere."""
    index = np.ix_(np.flatnonzero(free), np.flatnonzero(free))
    scale = np.sqrt(np.diag(covariance))[free]
    whole = np.zeros_like(covariance)
    inverse = np.linalg.pinv(covariance[index] / np.outer(scale, scale), hermitian=True)
    whole[index] = inverse / np.outer(scale, scale)
    return whole


def _settled(
    everything: HandEyeState, problem: HandEyeProblem, settings: HandEyeSettings, fit: Fit
) -> tuple[HandEyeEnd, HandEyeProblem, NoiseEstimate, Bool[Array, "n"]]:
    """Descend, find the arm's noise and the views it does not explain, until neither changes."""
    keep: Array = np.array(fit.agree) if settings.robust else np.ones(len(fit.agree), dtype=bool)
    if keep.sum() < max(FEWEST_POSES, 4):
        keep[:] = True
    state, noise = everything, problem.noise
    for _ in range(ROUNDS):
        try:
            now = refine_hand_eye(
                _with_ends(everything.keeping(keep), state), problem.keeping(keep).with_noise(noise)
            )
        except NoConvergence:
            if not settings.robust:
                raise
            break
        state = now.state
        if settings.robust:
            whole = reduced(_with_ends(everything, state), problem)
            new = explained_views(whole, keep, noise)
        else:
            new = keep
        found = _noise(reduced(now.state, problem.keeping(keep)), noise, settings)
        change = float(np.abs(np.log(found.noise.variances / noise.variances)).max())
        noise = found.noise
        if (new == keep).all() and change < NOISE_SETTLED:
            break
        keep = new
    last = problem.keeping(keep).with_noise(noise)
    end = refine_hand_eye(_with_ends(everything.keeping(keep), state), last)
    estimate = _noise(reduced(end.state, last), noise, settings)
    return end, last.with_noise(estimate.noise), estimate, keep


def _noise(problem: Reduced, start: ArmNoise, settings: HandEyeSettings) -> NoiseEstimate:
    if settings.noise is not None:
        # Taken as known: a variance that is known has all the information there is.
        information = component_information(problem.weighed(settings.noise))
        return NoiseEstimate(settings.noise, 1e12 * information)
    return estimate_noise(problem, start)


def _with_ends(state: HandEyeState, found: HandEyeState) -> HandEyeState:
    """The views of one state at the shared unknowns of another."""
    arm = state.arm
    if isinstance(arm, ArmGeometry) and isinstance(found.arm, ArmGeometry):
        arm = replace(arm, chain=found.arm.chain, values=found.arm.values)
    pictures = State(found.pictures.camera, state.pictures.cam_from_board, state.pictures.warp)
    return replace(
        state,
        base_from_fixed=found.base_from_fixed,
        wrist_from_carried=found.wrist_from_carried,
        pictures=pictures,
        arm=arm,
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
    whole = _with_ends(everything, state)
    off = surprise(reduced(whole, problem), keep, noise).off
    every_pose = state.setup.mount_from_far(whole.arm.base_from_wrist)
    seen = everything.pictures.cam_from_board
    return [
        Rejected(names[int(i)], reason(int(i), state, every_pose, seen[int(i)], noise, off[i], names))
        for i in np.flatnonzero(~keep)
    ]
