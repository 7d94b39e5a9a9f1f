"""What motions cannot tell is refused in words, with the direction; what an arm of five joints can tell."""

import numpy as np
import pytest

from tests.hand_eye_sets import posed
from vision_robot.arm import read_arm
from vision_robot.calibrate.hand_eye import HandEyeSettings, calibrate_hand_eye
from vision_robot.calibrate.hand_eye.degeneracy import check_motion, motion_of, unmoved_joints
from vision_robot.calibrate.hand_eye.setup import EYE_IN_HAND, EYE_TO_HAND
from vision_robot.errors import DegeneratePoses, TooFewPoses
from vision_robot.geometry import SE3, rotation_exp

RNG = np.random.default_rng(8)


def poses(rotvecs) -> SE3:
    rotvecs = np.asarray(rotvecs, dtype=float)
    return SE3.from_rotvec(rotvecs, RNG.uniform(-0.3, 0.3, (len(rotvecs), 3)))


def refused(setup, base_from_wrist, **options) -> str:
    with pytest.raises(DegeneratePoses) as caught:
        check_motion(setup, setup.mount_from_far(base_from_wrist), given=len(base_from_wrist), **options)
    return str(caught.value)


def test_no_turn_at_all():
    said = refused(EYE_IN_HAND, poses(np.tile([0.1, 0.2, 0.3], (6, 1))))
    assert "where the camera sits on the wrist cannot be known" in said
    assert "parallel" in said
    assert "turn the wrist" in said


@pytest.mark.parametrize(("axis", "name"), [((0, 0, 1), "z"), ((1, 0, 0), "x"), ((0, 1, 0), "y")])
def test_one_axis_names_the_direction_in_the_cameras_mount(axis, name):
    """Turns about the wrist's own axis leave the camera's place along it open; so for the base."""
    turns = np.linspace(-1, 1, 7)[:, None] * np.array(axis)
    in_wrist = SE3(rotation_exp(np.array([0.3, -0.2, 0.5])), np.zeros(3)) @ poses(turns)
    said = refused(EYE_IN_HAND, in_wrist)
    assert f"the camera's position along the wrist's {name} axis cannot be known" in said
    about_base = poses(turns) @ SE3(rotation_exp(np.array([0.3, -0.2, 0.5])), np.zeros(3))
    assert f"along the base's {name} axis" in refused(EYE_TO_HAND, about_base)


def test_an_axis_that_is_none_of_the_three_is_given_in_numbers():
    said = refused(EYE_IN_HAND, poses(np.linspace(-1, 1, 7)[:, None] * np.array([0.6, 0.0, 0.8])))
    assert "(0.60, 0.00, 0.80) of the wrist" in said.replace("-0.00", "0.00")


def test_half_turns_only():
    turns = np.pi * np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    said = refused(EYE_IN_HAND, poses(turns))
    assert "how the camera is turned cannot be known" in said
    assert "half turns" in said


def test_turns_that_drown_in_the_arms_noise():
    little = poses(np.radians(2.5) * RNG.normal(size=(10, 3)))
    check_motion(EYE_IN_HAND, little.inverse(), given=10)
    assert "cannot be known" in refused(EYE_IN_HAND, little, turn_noise=np.radians(1.0))


def test_copies_of_one_pose_count_once():
    one = poses(RNG.normal(size=(2, 3)))
    again = SE3(one.rotation[[0, 0, 0, 1, 1, 1]], one.translation[[0, 0, 0, 1, 1, 1]])
    with pytest.raises(TooFewPoses, match="only 2 of them differ"):
        check_motion(EYE_IN_HAND, again, given=6)


def test_the_column_arm_can_tell_all_when_it_pitches_and_says_which_joint_it_needs():
    chain = read_arm("column").chain
    joints = RNG.uniform(chain.limits[:, 0], chain.limits[:, 1], (12, 5))
    assert motion_of(chain.base_from_wrist(joints).inverse()).felt.min() > np.radians(20)
    joints[:, 3] = 0.0  # tool down: upright axes and roll all turn about the vertical
    idle = unmoved_joints(chain, joints)
    assert idle == ("theta4",)
    said = refused(EYE_IN_HAND, chain.base_from_wrist(joints), idle=idle)
    assert "along the wrist's z axis" in said
    assert "theta4 did not move" in said
    assert "with theta4" in said


def test_pictures_of_one_axis_are_refused_by_the_whole_calibration():
    made = posed(count=8, noise_px=0.2, shift_m=1e-5, turn=1e-6)
    turns = SE3.from_rotvec(np.linspace(-0.4, 0.4, 8)[:, None] * np.array([0, 0, 1.0]), np.zeros((8, 3)))
    arm = made.base_from_wrist[0] @ turns
    with pytest.raises(DegeneratePoses, match="the wrist's z axis"):
        calibrate_hand_eye(made.corners, arm, made.board, made.camera, HandEyeSettings(made.setup))
