"""From a closed form to the minimum: descent, the arm's noise, and the views it does not explain, in turn."""

from dataclasses import replace

import numpy as np

from vision_robot.calibrate.hand_eye.arm import ArmGeometry, GivenPoses
from vision_robot.calibrate.hand_eye.arm_noise import (
    LEAST,
    NoiseEstimate,
    component_information,
    estimate_noise,
)
from vision_robot.calibrate.hand_eye.board_poses import BoardViews
from vision_robot.calibrate.hand_eye.degeneracy import FEWEST_POSES
from vision_robot.calibrate.hand_eye.outliers import explained_views
from vision_robot.calibrate.hand_eye.problem import ArmNoise, HandEyeProblem
from vision_robot.calibrate.hand_eye.reduced import Reduced, reduced
from vision_robot.calibrate.hand_eye.refine import HandEyeEnd, refine_hand_eye
from vision_robot.calibrate.hand_eye.settings import HandEyeSettings
from vision_robot.calibrate.hand_eye.setup import Setup
from vision_robot.calibrate.hand_eye.start import Fit
from vision_robot.calibrate.hand_eye.state import HandEyeState
from vision_robot.calibrate.state import State
from vision_robot.errors import BadParameter, NoConvergence
from vision_robot.geometry import SE3, Camera, KnownCamera, SerialChain
from vision_robot.types import Array, Bool, Float

__all__ = ["joint_problem", "settle_hand_eye", "start_state", "with_ends"]

NOISE_SETTLED = 0.02
ROUNDS = 8
MEDIAN_LENGTH = 1.54
"""Of a three-dimensional Gaussian vector of unit sigma."""


def start_state(
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


def joint_problem(
    views: BoardViews, settings: HandEyeSettings, fit: Fit, camera: KnownCamera
) -> HandEyeProblem:
    """Corners, what is known of the camera, and a first guess of the arm's noise."""
    turn, shift = (float(np.median(part)) / MEDIAN_LENGTH for part in (fit.turn, fit.shift_m))
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


def settle_hand_eye(
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
                with_ends(everything.keeping(keep), state), problem.keeping(keep).with_noise(noise)
            )
        except NoConvergence:
            if not settings.robust:
                raise
            break
        state = now.state
        if settings.robust:
            whole = reduced(with_ends(everything, state), problem)
            new = explained_views(whole, keep, noise)
        else:
            new = keep
        found = _estimated(reduced(now.state, problem.keeping(keep)), noise, settings)
        change = float(np.abs(np.log(found.noise.variances / noise.variances)).max())
        noise = found.noise
        if (new == keep).all() and change < NOISE_SETTLED:
            break
        keep = new
    last = problem.keeping(keep).with_noise(noise)
    end = refine_hand_eye(with_ends(everything.keeping(keep), state), last)
    estimate = _estimated(reduced(end.state, last), noise, settings)
    return end, last.with_noise(estimate.noise), estimate, keep


def _estimated(problem: Reduced, start: ArmNoise, settings: HandEyeSettings) -> NoiseEstimate:
    if settings.noise is not None:
        # Taken as known: a variance that is known has all the information there is.
        information = component_information(problem.weighed(settings.noise))
        return NoiseEstimate(settings.noise, 1e12 * information)
    return estimate_noise(problem, start)


def with_ends(state: HandEyeState, found: HandEyeState) -> HandEyeState:
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
