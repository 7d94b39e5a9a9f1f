"""Every closed form gives back the truth without noise, and follows a change of frames."""

import numpy as np
import pytest

from vision_robot.calibrate.boards import Chessboard
from vision_robot.calibrate.hand_eye.board_poses import find_board_poses
from vision_robot.calibrate.hand_eye.closed_forms import CLOSED_FORMS, closed_form
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3
from vision_robot_synth.hand_eye import hand_eye_set

RNG = np.random.default_rng(3)


def exact(n: int = 8) -> tuple[SE3, SE3, SE3, SE3]:
    mount, far = SE3.exp(RNG.normal(size=6)), SE3.exp(RNG.normal(size=6))
    arm = SE3.exp(0.7 * RNG.normal(size=(n, 6)))
    return mount, far, arm, mount.inverse() @ arm @ far


def apart(one: SE3, other: SE3) -> float:
    return float(np.abs((one.inverse() @ other).log()).max())


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_without_noise_the_truth(name):
    mount, far, arm, seen = exact()
    found_mount, found_far = closed_form(name)(arm, seen)
    assert apart(found_mount, mount) < 1e-9
    assert apart(found_far, far) < 1e-9


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_another_wrist_frame_changes_the_answer_by_just_that(name):
    _, _, arm, seen = exact()
    change = SE3.exp(RNG.normal(size=6))
    before, _ = closed_form(name)(arm, seen)
    after, _ = closed_form(name)(change @ arm, seen)
    assert apart(after, change @ before) < 1e-8


def test_shah_needs_no_axes_where_the_others_have_none():
    """Half turns about three axes: rotation vectors have no sign there, matrices do."""
    mount, far = SE3.exp(RNG.normal(size=6)), SE3.exp(RNG.normal(size=6))
    turns = np.pi * np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.2, 0.1], [0, 0.2, -0.4]])
    arm = SE3.from_rotvec(turns, RNG.normal(size=(5, 3)))
    found, _ = closed_form("shah")(arm, mount.inverse() @ arm @ far)
    assert apart(found, mount) < 1e-9


def test_daniilidis_takes_the_right_root_where_a_null_vector_has_no_real_part():
    """A rendered cell whose two null vectors fall apart into rotation and translation, all but noise."""
    made = hand_eye_set("eye-to-hand", seed=66, board=Chessboard(11, 8, 0.03))
    views, _, _ = find_board_poses(made.corners(0.005), made.board.points, made.camera)
    found, _ = closed_form("daniilidis")(made.said, views.cam_from_board)
    assert np.linalg.norm(found.translation - made.cell.mount_from_cam.translation) < 2e-3


def test_an_unknown_name_is_refused_with_all_names():
    with pytest.raises(BadParameter, match="tsai-lenz, park-martin, daniilidis, shah"):
        closed_form("nobody")
