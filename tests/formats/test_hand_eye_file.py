"""The file of a hand-eye calibration comes back as it was, reads as a camera, and is checked when read."""

import json
from dataclasses import replace

import numpy as np
import pytest

from tests.views import CAMERAS
from vision_robot.arm import read_arm
from vision_robot.errors import BadCameraFile, BadParameter
from vision_robot.formats import read_camera
from vision_robot.formats.hand_eye import corrected_chain, read_hand_eye, write_hand_eye
from vision_robot.geometry import SE3, HandEye, rotation_exp

RNG = np.random.default_rng(2)


def some(setup: str) -> HandEye:
    A = RNG.normal(size=(12, 12)) * 1e-3
    poses = SE3.exp(RNG.normal(size=(2, 6)))
    return HandEye(setup, CAMERAS["brown5"], poses[0], poses[1], A @ A.T, 3e-4, 2e-4)


def moved(pose: SE3, steps: np.ndarray) -> SE3:
    return SE3(rotation_exp(steps[:, :3]) @ pose.rotation, pose.translation + steps[:, 3:])


@pytest.mark.parametrize("setup", ["eye-in-hand", "eye-to-hand"])
def test_round_trip(tmp_path, setup):
    found = some(setup)
    write_hand_eye(found, tmp_path / "he.json")
    again = read_hand_eye(tmp_path / "he.json")
    assert again.setup == setup
    assert np.allclose(again.mount_from_cam.as_matrix(), found.mount_from_cam.as_matrix(), atol=1e-14)
    assert np.allclose(again.far_from_board.as_matrix(), found.far_from_board.as_matrix(), atol=1e-14)
    assert np.allclose(again.covariance, found.covariance, rtol=1e-12, atol=1e-20)
    assert (again.arm_turn, again.arm_shift_m) == (3e-4, 2e-4)
    assert read_camera(tmp_path / "he.json") == found.camera
    keys = json.loads((tmp_path / "he.json").read_text())
    assert {"eye-in-hand": "wrist_from_cam", "eye-to-hand": "base_from_cam"}[setup] in keys


def test_corrected_links_come_back(tmp_path):
    chain = read_arm("column").chain
    links = chain.link_from_joint @ SE3.exp(1e-3 * RNG.normal(size=(5, 6)))
    found = replace(chain, link_from_joint=links)
    write_hand_eye(some("eye-in-hand"), tmp_path / "he.json", found)
    again = corrected_chain(tmp_path / "he.json", chain)
    assert np.allclose(again.link_from_joint.as_matrix(), links.as_matrix(), atol=1e-14)
    other = replace(chain, joint_names=("a", "b", "c", "d", "e"))
    with pytest.raises(BadCameraFile, match="joints a, b, c, d, e expected"):
        corrected_chain(tmp_path / "he.json", other)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"setup": "eye-on-foot"}, "eye-in-hand or eye-to-hand"),
        ({"wrist_from_cam": None}, "wrist_from_cam"),
        ({"hand_eye_covariance": {"parameters": [], "matrix": []}}, "missing"),
    ],
)
def test_a_damaged_file_is_refused_by_its_key(tmp_path, change, says):
    write_hand_eye(some("eye-in-hand"), tmp_path / "he.json")
    tree = {**json.loads((tmp_path / "he.json").read_text()), **change}
    (tmp_path / "he.json").write_text(json.dumps({k: v for k, v in tree.items() if v is not None}))
    with pytest.raises(BadCameraFile, match=says):
        read_hand_eye(tmp_path / "he.json")


def test_where_the_camera_is_and_how_sure_a_point_is():
    in_hand, to_hand = some("eye-in-hand"), some("eye-to-hand")
    wrist = SE3.exp(RNG.normal(size=6))
    assert np.allclose(in_hand.base_from_cam(wrist).as_matrix(), (wrist @ in_hand.mount_from_cam).as_matrix())
    assert to_hand.base_from_cam() is to_hand.mount_from_cam
    with pytest.raises(BadParameter, match="base_from_wrist"):
        in_hand.base_from_cam()
    # By chance instead of derivatives: the point under drawn errors of mounting and arm.
    point, n = np.array([0.05, -0.02, 0.4]), 20000
    shaken = RNG.normal(size=(n, 6)) * np.repeat([3e-4, 2e-4], 3)
    draws = RNG.multivariate_normal(np.zeros(12), in_hand.covariance * 1e-2, n)
    small = replace(in_hand, covariance=in_hand.covariance * 1e-2)
    mount, arm = moved(in_hand.mount_from_cam, draws[:, :6]), moved(wrist, shaken)
    seen = (arm @ mount).apply(np.tile(point, (n, 1, 1)))[:, 0]
    stated = small.base_covariance(point, wrist)
    assert np.allclose(np.cov(seen.T), stated, atol=0.05 * np.trace(stated))
