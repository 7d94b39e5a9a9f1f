"""Room for the lines of sight: a bone on the line leaves none, one beside it its distance."""

import numpy as np
import pytest

from vision_robot.arm import read_arm
from vision_robot.geometry import WorkPlane
from vision_robot.pick.servo.clear_sight import clearance_m, skeleton
from vision_robot.pick.world import ordinary_world

VIEW = ordinary_world().view
PLANE = WorkPlane.exact(VIEW.camera, VIEW.cam_from_station)
EYE = VIEW.cam_from_station.inverse().translation
CORNER = np.array([[0.0, 0.0, 0.1]])


def test_a_bone_on_the_line_leaves_no_room_and_one_beside_it_its_distance():
    on_line = EYE + 0.7 * (CORNER - EYE)
    assert clearance_m(PLANE, on_line, CORNER) == pytest.approx(0.0, abs=1e-12)
    beside = on_line + np.array([0.0, 0.04, 0.0])  # the line has no y
    assert clearance_m(PLANE, beside, CORNER) == pytest.approx(0.04)


def test_what_lies_behind_the_label_hides_nothing():
    under = np.array([[0.0, 0.0, 0.0]])
    assert clearance_m(PLANE, under, CORNER) == pytest.approx(0.1, rel=0.05)


def test_outside_the_picture_there_is_less_than_no_room():
    assert clearance_m(PLANE, np.array([[0.0, 0.0, 0.0]]), np.array([[0.0, 0.6, 0.1]])) < 0


def test_the_skeleton_runs_from_the_base_to_the_wrist():
    chain = read_arm("column").chain
    joints = np.mean(chain.limits, axis=1)
    bones = skeleton(chain, joints)
    assert bones[0].tolist() == [0, 0, 0]
    assert np.allclose(bones[-1], chain.base_from_wrist(joints).translation)
    assert np.linalg.norm(np.diff(bones, axis=0), axis=1).max() < 0.03
