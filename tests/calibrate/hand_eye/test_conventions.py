"""Poses that mean something else than taken for are found by what fits the pictures, and said in words."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.hand_eye_sets import Posed, posed
from vision_robot.arm import read_arm
from vision_robot.calibrate.hand_eye import HandEyeSettings, calibrate_hand_eye
from vision_robot.calibrate.hand_eye.conventions import check_joints
from vision_robot.calibrate.hand_eye.pose_table import PoseTable, Reading
from vision_robot.calibrate.hand_eye.setup import EYE_IN_HAND
from vision_robot.errors import ContradictingPoses
from vision_robot.geometry import SE3


def table(pose: SE3, kind: str, reading: Reading, length: float = 1.0) -> PoseTable:
    """Poses as a file of that kind would hold them."""
    turned = Rotation.from_matrix(pose.rotation)
    turn = {
        "xyzw": turned.as_quat,
        "rotvec": turned.as_rotvec,
        "degrees": lambda: np.degrees(turned.as_rotvec()),
        "XYZ": lambda: turned.as_euler("XYZ", degrees=True),
        "transposed": lambda: np.swapaxes(pose.rotation, 1, 2).reshape(-1, 9),
    }[kind]()
    rows = tuple(f"line {i + 2}" for i in range(len(pose)))
    return PoseTable("poses.csv", reading, pose.translation * length, turn, None, rows)


def solve(made: Posed, poses: PoseTable):
    return calibrate_hand_eye(made.corners, poses, made.board, made.camera, HandEyeSettings(made.setup))


@pytest.mark.parametrize(
    ("kind", "reading", "length", "inverse", "says"),
    [
        ("xyzw", Reading("quaternion", "xyzw"), 1e3, False, "give --pose-unit mm"),
        ("xyzw", Reading("quaternion", "xyzw", length="mm"), 1.0, False, "give --pose-unit m"),
        ("xyzw", Reading("quaternion", "wxyz"), 1.0, False, "give --rotation xyzw"),
        ("xyzw", Reading("quaternion", "wxyz"), 1e3, False, "--rotation xyzw --pose-unit mm"),
        ("degrees", Reading("rotvec"), 1.0, False, "give --angle-unit deg"),
        ("rotvec", Reading("rotvec", angle="deg"), 1.0, False, "give --angle-unit rad"),
        ("degrees", Reading("euler", "xyz", angle="deg"), 1.0, False, "--rotation rotvec --angle-unit deg"),
        ("XYZ", Reading("euler", "xyz", angle="deg"), 1.0, False, "--rotation XYZ"),
        ("transposed", Reading("matrix"), 1.0, False, "--rotation columns"),
        ("xyzw", Reading("quaternion", "xyzw"), 1.0, True, "--inverse"),
    ],
)
def test_each_mistake_is_named_with_its_cure(kind, reading, length, inverse, says):
    made = posed("eye-to-hand" if len(says) % 2 else "eye-in-hand", 8, seed=1)
    with pytest.raises(ContradictingPoses) as caught:
        solve(made, table(made.said.inverse() if inverse else made.said, kind, reading, length))
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("kind", "reading"),
    [
        ("xyzw", Reading("quaternion", "xyzw")),
        ("rotvec", Reading("rotvec")),
        ("transposed", Reading("matrix", transposed=True)),
    ],
)
def test_poses_that_mean_what_they_say_are_taken(kind, reading):
    made = posed(count=8, seed=1)
    result = solve(made, table(made.said, kind, reading))
    assert np.linalg.norm(result.mount_from_cam.translation - made.truth.mount_from_cam.translation) < 2e-3


def test_the_other_set_up_is_proposed():
    made = posed("eye-to-hand", 8, seed=2)
    wrong = table(made.said, "xyzw", Reading("quaternion", "xyzw"))
    with pytest.raises(ContradictingPoses, match="--setup eye-to-hand"):
        calibrate_hand_eye(made.corners, wrong, made.board, made.camera, HandEyeSettings("eye-in-hand"))


def test_a_poor_arm_is_not_taken_for_a_mistake():
    made = posed(count=10, seed=3, turn=np.radians(0.5), shift_m=5e-3)
    result = solve(made, table(made.said, "xyzw", Reading("quaternion", "xyzw")))
    assert result.noise.noise.shift_m == pytest.approx(5e-3, rel=0.6)


def test_joint_values_in_degrees_are_named():
    chain = read_arm("column").chain
    rng = np.random.default_rng(0)
    joints = rng.uniform(chain.limits[:, 0], chain.limits[:, 1], (8, 5))
    X, Z = SE3.exp(rng.normal(size=6) * 0.2), SE3.exp(rng.normal(size=6) * 0.2)
    seen = X.inverse() @ chain.base_from_wrist(joints).inverse() @ Z
    small = np.where(chain.slides, 1.0, 180 / np.pi)
    check_joints(chain, joints, EYE_IN_HAND, seen)
    with pytest.raises(ContradictingPoses, match="hinges in degrees"):
        check_joints(chain, joints * small, EYE_IN_HAND, seen)
