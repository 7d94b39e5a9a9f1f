"""Hand-eye: truth within its own intervals, better than the closed forms, honest when it cannot know."""

import numpy as np
import pytest

from tests.hand_eye_sets import SHIFT_M, TURN, posed
from vision_robot.calibrate.hand_eye import ArmNoise, HandEyeSettings, calibrate_hand_eye
from vision_robot.calibrate.hand_eye.setup import SETUPS
from vision_robot.errors import BadParameter, TooFewPoses
from vision_robot.evaluate.hand_eye import hand_eye_error
from vision_robot.geometry import SE3, KnownCamera


def solve(made, **options):
    settings = HandEyeSettings(made.setup, **options)
    return calibrate_hand_eye(made.corners, made.said, made.board, made.camera, settings)


@pytest.mark.parametrize("setup", SETUPS)
def test_without_noise_the_truth(setup):
    made = posed(setup, 8, noise_px=1e-4, turn=0.0, shift_m=0.0)
    error = hand_eye_error(solve(made).hand_eye, made.truth)
    assert np.abs(error.step).max() < 1e-5


@pytest.mark.parametrize("setup", SETUPS)
def test_over_trials_ours_is_nearest_and_its_intervals_hold_the_truth(setup):
    held, errors = [], {}
    for seed in range(12):
        made = posed(setup, seed=seed)
        result = solve(made)
        error = hand_eye_error(result.hand_eye, made.truth)
        held.append(np.abs(error.step) <= result.covariance.half_width)
        found = {"ours": result.mount_from_cam, **{n: form[0] for n, form in result.closed_forms.items()}}
        for name, mount in found.items():
            shift = np.linalg.norm(mount.translation - made.truth.mount_from_cam.translation)
            errors.setdefault(name, []).append(shift)
        assert not result.rejected
    medians = {name: np.median(values) for name, values in errors.items()}
    assert min(medians, key=medians.get) == "ours", medians  # pyright: ignore
    assert 0.90 <= np.mean(held) <= 0.99


def test_the_arms_noise_is_found():
    made = posed(count=60, seed=1)
    result = solve(made)
    assert result.noise.noise.shift_m == pytest.approx(SHIFT_M, rel=4 * result.noise.relative_sigma[1])
    assert result.noise.noise.turn == pytest.approx(TURN, rel=4 * result.noise.relative_sigma[0])
    assert result.noise.relative_sigma.max() < 0.12
    assert result.noise_px == pytest.approx(0.2, rel=0.05)


def test_an_arm_taken_as_exact_is_worse():
    """The reason why the arm's noise is estimated at all."""
    off = {"estimated": [], "exact": []}
    for seed in range(6):
        made = posed(seed=seed)
        true = made.truth.mount_from_cam.translation
        off["estimated"].append(np.linalg.norm(solve(made).mount_from_cam.translation - true))
        exact = solve(made, noise=ArmNoise(1e-6, 1e-6), robust=False)
        off["exact"].append(np.linalg.norm(exact.mount_from_cam.translation - true))
    assert np.median(off["exact"]) > 1.2 * np.median(off["estimated"])


def test_an_uncertain_camera_is_estimated_along():
    """A focal length off by half a percent, told to be known no better, is put right."""
    made = posed(count=15, seed=2)
    wrong = made.camera.parameters * np.array([1.005, 1.005, *[1.0] * 8])
    covariance = np.zeros((10, 10))
    covariance[0, 0] = covariance[1, 1] = 25.0
    camera = made.camera.with_parameters(wrong)
    settings = HandEyeSettings(made.setup)
    known = KnownCamera(camera, covariance)
    result = calibrate_hand_eye(made.corners, made.said, made.board, known, settings)
    assert result.camera.fx == pytest.approx(made.camera.fx, abs=0.5)
    error = hand_eye_error(result.hand_eye, made.truth)
    assert np.abs(error.in_sigma).max() < 4
    stubborn = calibrate_hand_eye(made.corners, made.said, made.board, camera, settings)
    assert stubborn.noise.noise.shift_m > 2 * result.noise.noise.shift_m


def test_a_free_camera_is_found_from_the_views():
    made = posed(count=15, seed=3)
    camera = made.camera.with_parameters(made.camera.parameters * np.array([1.01, 1.01, *[1.0] * 8]))
    settings = HandEyeSettings(made.setup, free_camera=True)
    result = calibrate_hand_eye(made.corners, made.said, made.board, camera, settings)
    assert result.camera.fx == pytest.approx(made.camera.fx, rel=2e-3)


def test_counts_that_differ_and_too_few_are_refused():
    made = posed(count=6)
    with pytest.raises(BadParameter, match="number of poses is 5: it must be 6"):
        calibrate_hand_eye(made.corners, made.said[:5], made.board, made.camera)
    with pytest.raises(TooFewPoses, match="2 usable"):
        calibrate_hand_eye(made.corners[:2], made.said[:2], made.board, made.camera)
    same = SE3(made.said.rotation[[0] * 6], made.said.translation[[0] * 6])
    with pytest.raises(TooFewPoses, match="only 1 of them differ"):
        calibrate_hand_eye(made.corners, same, made.board, made.camera)


def test_geometry_without_a_model_is_refused():
    from vision_robot.calibrate.hand_eye import GeometryTolerance

    made = posed(count=5)
    with pytest.raises(BadParameter, match="arm geometry"):
        solve(made, geometry=GeometryTolerance())


def test_results_do_not_depend_on_the_order_of_the_views():
    made = posed(count=8, seed=4)
    first = solve(made)
    order = np.random.default_rng(0).permutation(8)
    again = calibrate_hand_eye(
        [made.corners[i] for i in order],
        made.said[order],
        made.board,
        made.camera,
        HandEyeSettings(made.setup),
    )
    assert np.allclose(first.mount_from_cam.translation, again.mount_from_cam.translation, atol=1e-7)
