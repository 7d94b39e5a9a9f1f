"""Pairs out of step, shuffled, swapped or taken while the arm moved are found, and named."""

import numpy as np
import pytest

from tests.hand_eye_sets import posed
from vision_robot.calibrate import Corners
from vision_robot.calibrate.hand_eye import HandEyeSettings, calibrate_hand_eye
from vision_robot.calibrate.hand_eye.pairing import between
from vision_robot.errors import ContradictingPoses
from vision_robot.geometry import SE3


def solve(made, said: SE3, corners=None):
    return calibrate_hand_eye(
        corners or made.corners, said, made.board, made.camera, HandEyeSettings(made.setup)
    )


@pytest.mark.parametrize(
    ("lag", "says"), [(1, "picture 1 belongs to pose 2"), (-2, "picture 3 belongs to pose 1")]
)
def test_lists_out_of_step(lag, says):
    """Of twelve stops the first pictures, or the first poses, are missing."""
    made = posed("eye-to-hand" if lag > 0 else "eye-in-hand", 12, seed=1)
    corners = made.corners[lag:] if lag > 0 else made.corners[:lag]
    said = made.said[: 12 - lag] if lag > 0 else made.said[-lag:]
    with pytest.raises(ContradictingPoses) as caught:
        solve(made, said, corners)
    assert "out of step" in str(caught.value)
    assert says in str(caught.value)
    order = np.array(caught.value.order)
    assert (order[order >= 0] - np.flatnonzero(order >= 0) == lag).all()


def test_a_shuffled_list_is_put_in_order():
    made = posed(count=12, seed=2)
    order = np.random.default_rng(1).permutation(12)
    with pytest.raises(ContradictingPoses, match="shuffled") as caught:
        solve(made, made.said[order])
    found = np.array(caught.value.order)
    assert (order[found[found >= 0]] == np.flatnonzero(found >= 0)).all()
    assert (found >= 0).sum() >= 10


def test_two_swapped_pairs_are_left_out_and_named():
    made = posed(count=12, seed=3)
    order = np.arange(12)
    order[[3, 8]] = order[[8, 3]]
    result = solve(made, made.said[order])
    assert [one.image for one in result.rejected] == ["view 3", "view 8"]
    assert "fits the pose of view 8 instead" in result.rejected[0].reason
    assert "fits the pose of view 3 instead" in result.rejected[1].reason


def test_a_picture_taken_on_the_way_is_named():
    """The pose noted of view 5 is the last stop's; the picture was taken 40 % of the way to view 6."""
    made = posed(count=12, seed=4, turn=1e-6, shift_m=1e-6)
    arm = made.said.inverse()
    on_the_way = between(arm[np.array([5, 6])], 0.4)[0]
    seen = made.truth.mount_from_cam.inverse() @ on_the_way @ made.truth.far_from_board
    corners = list(made.corners)
    pixels = made.camera.project(seen.apply(made.board))
    corners[5] = Corners("view 5", np.arange(len(pixels)), pixels)
    result = solve(made, made.said, corners)
    assert [one.image for one in result.rejected] == ["view 5"]
    assert "40 % of the way to the next pose" in result.rejected[0].reason


@pytest.mark.parametrize("setup", ["eye-in-hand", "eye-to-hand"])
@pytest.mark.parametrize("off_m", [0.005, 0.05])
def test_one_wrong_pose_is_left_out_with_its_size(setup, off_m):
    made = posed(setup, 15, seed=5)
    translation = made.said.translation.copy()
    translation[4, 0] += off_m
    result = solve(made, SE3(made.said.rotation, translation))
    assert [one.image for one in result.rejected] == ["view 4"]
    assert "its pose and its picture disagree by" in result.rejected[0].reason
    clean = solve(made, made.said)
    moved = result.mount_from_cam.translation - clean.mount_from_cam.translation
    assert np.linalg.norm(moved) < 3 * clean.covariance.position_m


def test_a_third_of_wrong_poses_does_not_carry_the_rest_away():
    made = posed(count=15, seed=6)
    translation = made.said.translation.copy()
    wrong = [1, 4, 7, 10, 13]
    translation[wrong] += np.random.default_rng(0).normal(size=(5, 3)) * 0.05
    result = solve(made, SE3(made.said.rotation, translation))
    assert [one.image for one in result.rejected] == [f"view {i}" for i in wrong]
