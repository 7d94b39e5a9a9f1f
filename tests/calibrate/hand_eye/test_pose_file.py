"""Pose files: what the columns mean, in every spelling, and one line for what cannot be used."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.arm.arms import UR5E
from vision_robot.arm import read_arm
from vision_robot.calibrate.hand_eye.pose_file import read_poses
from vision_robot.errors import BadPoseFile
from vision_robot.geometry import SE3

RNG = np.random.default_rng(1)
POSES = SE3.from_rotvec(RNG.normal(size=(4, 3)), RNG.uniform(-0.5, 0.5, (4, 3)))
TURNED = Rotation.from_matrix(POSES.rotation)
T, W = POSES.translation, POSES.rotvec()
SQUARE = ",".join(f"r{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3))
WHOLE = ",".join(f"m{i}{j}" for i in range(4) for j in range(4))


BACK = (POSES.inverse().translation, POSES.inverse().rotvec())


def rows(*arrays):
    """Rows of several arrays as lists."""
    return zip(*(array.tolist() for array in arrays), strict=True)


def text(header: str | None, rows, first=()) -> str:
    lines = [] if header is None else [header]
    names = first or [""] * len(rows)
    for name, row in zip(names, rows, strict=True):
        lines.append(",".join([*([name] if name else []), *(repr(float(value)) for value in row)]))
    return "\n".join(lines)


@pytest.mark.parametrize(
    "content",
    [
        text("x,y,z,qx,qy,qz,qw", np.c_[T, TURNED.as_quat()]),
        text("qw,qx,qy,qz,x_mm,y_mm,z_mm", np.c_[np.roll(TURNED.as_quat(), 1, axis=1), 1e3 * T]),
        text("time,tx,ty,tz,rx,ry,rz", np.c_[np.arange(4), T, TURNED.as_rotvec()]),
        text("x,y,z,rx_deg,ry_deg,rz_deg", np.c_[T, np.degrees(TURNED.as_rotvec())]),
        text("X_mm,Y_mm,Z_mm,A,B,C", np.c_[1e3 * T, TURNED.as_euler("ZYX", degrees=True)]),
        text("x,y,z,w,p,r", np.c_[T, TURNED.as_euler("xyz", degrees=True)]),
        text("x,y,z,roll,pitch,yaw", np.c_[T, TURNED.as_euler("xyz")]),
        text(WHOLE, POSES.as_matrix().reshape(-1, 16)),
        text(f"x,y,z,{SQUARE}", np.c_[T, POSES.rotation.reshape(-1, 9)]),
        text(None, np.c_[T, TURNED.as_rotvec()]),
        text(None, np.c_[T, TURNED.as_quat()]),
        text(None, np.c_[np.arange(4), T, TURNED.as_quat()]),
        text(None, POSES.as_matrix()[:, :3].reshape(-1, 12)),
        "# a remark\n" + text(None, np.c_[T, TURNED.as_quat()]).replace(",", " "),
        text("image,x,y,z,rx,ry,rz", np.c_[T, TURNED.as_rotvec()], list("abcd")).replace(",", ";"),
        json.dumps([{"matrix": m.tolist()} for m in POSES.as_matrix()]),
        json.dumps([m.tolist() for m in POSES.as_matrix()]),
        json.dumps({"poses": [{"translation_mm": t, "rotvec_rad": r} for t, r in rows(1e3 * T, W)]}),
        json.dumps([{"position": t, "quaternion_xyzw": q} for t, q in rows(T, TURNED.as_quat())]),
        json.dumps([{"base_from_wrist": {"translation_m": t, "rotvec_rad": r}} for t, r in rows(T, W)]),
        json.dumps([{"wrist_from_base": {"translation_m": t, "rotvec_rad": r}} for t, r in rows(*BACK)]),
    ],
)  # fmt: skip
def test_every_spelling_gives_the_poses(tmp_path, content):
    path = tmp_path / "poses.csv"
    path.write_text(content)
    found = read_poses(path).base_from_wrist
    assert np.allclose(found.rotation, POSES.rotation, atol=1e-12)
    assert np.allclose(found.translation, T, atol=1e-12)


def test_pictures_joints_and_remarks(tmp_path):
    path = tmp_path / "poses.csv"
    path.write_text(
        "image,x,y,z,rx,ry,rz,d1_mm,theta2_deg,theta3,theta4,theta5,remark\n"
        "a.png,0,0,0,0,0,1,120,90,0,0.1,0.2,first\nb.png,0,0,1,0,1,0,130,45,0,0,0,second\n"
    )
    table = read_poses(path)
    assert table.names == ("a.png", "b.png")
    joints = table.joint_values(read_arm("column").chain)
    assert np.allclose(joints[0], [0.12, np.pi / 2, 0, 0.1, 0.2])


def test_joints_alone_and_joints_of_another_arm(tmp_path):
    path = tmp_path / "joints.csv"
    path.write_text("j1,j2,j3,j4,j5,j6\n" + "\n".join(["0,1,2,3,0.5,0.1"] * 3))
    table = read_poses(path)
    assert not table.has_poses
    assert table.joint_values(UR5E).shape == (3, 6)
    with pytest.raises(BadPoseFile, match="6 joint columns"):
        table.joint_values(read_arm("column").chain)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "empty"),
        ("x,y,z,rx,ry,rz\n", "no pose"),
        ("x,y,z,rx,ry,rz\n1,2,3,4,5", "line 2 has 5 fields"),
        ("x,y,z,rx,ry,rz\n1,2,three,4,5,6", "line 2: z is 'three'"),
        ("x,y,z,rx,ry,rz\n1,2,nan,4,5,6", "not a finite number"),
        ("x,y,z\n1,2,3", "lack a rotation"),
        ("rx,ry,rz\n1,2,3", "lack x, y, z"),
        ("x_mm,y_m,z_mm,rx,ry,rz\n1,2,3,0,0,0", "different units"),
        ("x,x,z,rx,ry,rz\n1,2,3,0,0,0", "two columns are called x"),
        ("1,2,3,4,5", "5 numbers a row"),
        ("x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n0,0,0,1,1,1,1", "line 3: its quaternion is not of length one"),
        (text(f"x,y,z,{SQUARE}", [[0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 1]]), "no rotation"),
        (text(f"x,y,z,{SQUARE}", [[0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -1]]), "mirror"),
        ("{", "line 1"),
        ('{"camera": 1}', "a list of poses"),
        ("[1, 2]", "pose 1"),
    ],
)  # fmt: skip
def test_what_cannot_be_used_is_one_line_with_its_place(tmp_path, content, says):
    path = tmp_path / "poses.csv"
    path.write_text(content)
    with pytest.raises(BadPoseFile) as caught:
        _ = read_poses(path).base_from_wrist
    assert says in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_degrees_without_a_name_are_suspected(tmp_path):
    path = tmp_path / "joints.csv"
    path.write_text("d1,theta2,theta3,theta4,theta5\n0.1,90,45,30,20\n")
    with pytest.raises(BadPoseFile, match="are these degrees"):
        read_poses(path).joint_values(read_arm("column").chain)
    with pytest.raises(BadPoseFile, match="no such file"):
        read_poses(tmp_path / "none.csv")
