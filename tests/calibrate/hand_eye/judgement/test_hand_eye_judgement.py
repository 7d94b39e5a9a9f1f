"""Judgement of a hand-eye: held-out views, error budget, board scale, next poses, and what is said."""

import numpy as np
import pytest

from tests.hand_eye_sets import Posed, posed
from vision_robot.arm import read_arm
from vision_robot.calibrate.hand_eye import HandEyeResult, HandEyeSettings, calibrate_hand_eye
from vision_robot.calibrate.hand_eye.judgement import judge_hand_eye
from vision_robot.calibrate.hand_eye.judgement.board_scale import board_scale
from vision_robot.calibrate.hand_eye.judgement.error_budget import hand_eye_budget
from vision_robot.calibrate.hand_eye.judgement.held_out import hold_out_views
from vision_robot.calibrate.hand_eye.judgement.next_pose import next_poses
from vision_robot.geometry import SE3
from vision_robot_synth.hand_eye import hand_eye_set


def solve(made: Posed, board: np.ndarray | None = None) -> HandEyeResult:
    board = made.board if board is None else board
    return calibrate_hand_eye(made.corners, made.said, board, made.camera, HandEyeSettings(made.setup))


@pytest.fixture(scope="module")
def result() -> HandEyeResult:
    return solve(posed(count=12, seed=1))


def test_a_held_out_view_errs_as_a_fit_without_it_says(result):
    """One Gauss-Newton step against solving again without the view, noise held."""
    made = posed(count=12, seed=1)
    keep = [i for i in range(12) if i != 4]
    settings = HandEyeSettings(made.setup, noise=result.noise.noise, robust=False)
    without = calibrate_hand_eye(
        [made.corners[i] for i in keep], made.said[np.array(keep)], made.board, made.camera, settings
    )
    said = without.mount_from_cam.inverse() @ made.said[4].inverse() @ without.far_from_board
    off = made.camera.project(said.apply(made.board)) - made.corners[4].pixels
    by_hand = float(np.sqrt(np.mean(np.sum(off**2, axis=1))))
    assert hold_out_views(result).rms_px[4] == pytest.approx(by_hand, rel=0.02)


def test_held_out_errors_are_as_foretold_over_trials():
    ratios = [hold_out_views(solve(posed(count=12, seed=seed))).ratio for seed in range(5)]
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.12)


def test_the_causes_add_up_in_squares(result):
    budget = hand_eye_budget(result)
    # What Kenward and Roger add for few views belongs to no cause.
    total = np.sqrt(sum(value**2 for value in budget.mount.values()))
    assert total == pytest.approx(result.covariance.position_m, rel=0.03)
    assert total <= result.covariance.position_m
    assert budget.dominant == "arm"
    assert "arm at that moment" in budget.look


def test_a_camera_that_stands_needs_no_arm_to_look():
    assert "arm at that moment" not in hand_eye_budget(solve(posed("eye-to-hand", 10, seed=2))).look


def test_bad_pictures_make_the_camera_dominate():
    made = posed(count=12, seed=3, noise_px=2.0, turn=1e-5, shift_m=1e-5)
    judgement = judge_hand_eye(solve(made))
    assert judgement.budget.dominant == "camera"
    assert "the camera dominates" in judgement.verdict


def test_a_board_printed_too_small_is_found_and_said():
    made = posed(count=15, seed=4)
    assert not board_scale(solve(made)).doubtful
    scale = board_scale(solve(made, 1.01 * made.board))
    assert scale.scale == pytest.approx(1 / 1.01, abs=4 * scale.sigma)
    assert scale.doubtful
    said = " ".join(judge_hand_eye(solve(made, 1.01 * made.board)).advice)
    assert "times its stated size" in said


def test_the_next_pose_lowers_the_sigma_as_foretold_and_keeps_the_limits():
    made = hand_eye_set(views=6, seed=1)
    result = calibrate_hand_eye(made.corners(0.2), made.said, made.board.points, made.camera)
    chain = read_arm("column").chain
    proposed = next_poses(result, arm=chain, count=2)
    assert proposed.joints is not None
    assert chain.within_limits(proposed.joints).all()
    assert proposed.together_m[1] < proposed.together_m[0] < proposed.sigma_m
    assert proposed.words[0].startswith("drive the wrist to x")
    more = made.driven_to(proposed.joints[0])
    settings = HandEyeSettings(noise=result.noise.noise)
    after = calibrate_hand_eye(more.corners(0.2), more.said, made.board.points, made.camera, settings)
    again = next_poses(after, arm=chain, count=1)
    assert again.sigma_m == pytest.approx(proposed.together_m[0], rel=0.1)


def test_without_a_model_the_proposed_poses_are_like_those_so_far(result):
    proposed = next_poses(result, count=2)
    assert proposed.joints is None
    place, used = proposed.base_from_wrist.translation, result.base_from_wrist.translation
    assert (place > used.min(axis=0) - 0.2).all()
    assert (place < used.max(axis=0) + 0.2).all()


def test_few_views_and_unanswered_questions_are_said():
    made = posed(count=5, seed=6)
    judgement = judge_hand_eye(solve(made))
    assert "views are few" in " ".join(judgement.advice)
    assert judgement.verdict in judgement.sentences


def test_the_same_seed_proposes_the_same_pose(result):
    first, again = next_poses(result, count=1, seed=3), next_poses(result, count=1, seed=3)
    assert np.array_equal(first.base_from_wrist.as_matrix(), again.base_from_wrist.as_matrix())
    assert isinstance(first.base_from_wrist, SE3)
