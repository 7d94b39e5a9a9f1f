"""Synthetic hand-eye sets: their truth is what the pictures show, the same seed is the same set."""

import numpy as np
import pytest

from vision_robot.calibrate.hand_eye.pose_file import read_poses
from vision_robot.errors import BadParameter, UnwritableOutput
from vision_robot.formats import read_camera
from vision_robot.formats.hand_eye import read_hand_eye
from vision_robot_synth.hand_eye import hand_eye_set
from vision_robot_synth.hand_eye_folder import write_hand_eye_set

CELLS = [(arm, setup) for arm in ("column", "six-axis") for setup in ("eye-in-hand", "eye-to-hand")]


@pytest.mark.parametrize(("arm", "setup"), CELLS)
def test_the_whole_board_is_seen_and_joints_keep_their_limits(arm, setup):
    made = hand_eye_set(setup, arm=arm, views=10, seed=3)
    assert made.cell.arm.within_limits(made.joints).all()
    pixels = made.camera.project(made.cam_from_board.apply(made.board.points))
    assert np.isfinite(pixels).all()
    assert (pixels > -0.5).all()
    assert (pixels < [1279.5, 959.5]).all()


def test_what_the_arm_says_is_off_by_its_noise_and_its_links():
    made = hand_eye_set(views=40, seed=1)
    off = made.base_from_wrist.translation - made.said.translation
    assert np.std(off) == pytest.approx(0.3e-3, rel=0.25)
    bent = hand_eye_set(views=10, link_errors=(np.radians(0.3), 1e-3), seed=1)
    assert np.linalg.norm(bent.base_from_wrist.translation - bent.said.translation, axis=1).mean() > 1e-3


def test_the_same_seed_the_same_set_and_pictures():
    first, again = hand_eye_set(views=3, seed=5), hand_eye_set(views=3, seed=5)
    assert np.array_equal(first.joints, again.joints)
    (a,), (b,) = first.images([1]), again.images([1])
    assert np.array_equal(a, b)
    assert not np.array_equal(first.joints, hand_eye_set(views=3, seed=6).joints)


def test_a_further_view_leaves_the_others_as_they_were():
    made = hand_eye_set(views=3, seed=5)
    more = made.driven_to(made.joints[0])
    assert len(more) == 4
    assert np.array_equal(more.base_from_wrist.as_matrix()[:3], made.base_from_wrist.as_matrix())


def test_a_set_on_disk_reads_back(tmp_path):
    made = hand_eye_set(views=2, seed=1)
    write_hand_eye_set(made, tmp_path / "set")
    table = read_poses(tmp_path / "set" / "poses.csv")
    assert np.allclose(table.base_from_wrist.as_matrix(), made.said.as_matrix(), atol=1e-8)
    assert np.allclose(table.joint_values(made.cell.arm), made.joints, atol=1e-8)
    assert read_camera(tmp_path / "set" / "camera.json") == made.camera
    truth = read_hand_eye(tmp_path / "set" / "truth.json")
    assert np.allclose(truth.mount_from_cam.as_matrix(), made.cell.mount_from_cam.as_matrix())
    with pytest.raises(UnwritableOutput):
        write_hand_eye_set(made, tmp_path / "set")


@pytest.mark.parametrize("options", [{"arm": "snake"}, {"views": 0}, {"seed": -1}, {"setup": "eye-on-foot"}])
def test_what_cannot_be_made_is_refused(options):
    with pytest.raises(BadParameter):
        hand_eye_set(**options)
