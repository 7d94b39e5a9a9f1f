"""URDF: MuJoCo's own reading of the same file to 1e-12 m, and what cannot be used named."""

import numpy as np
import pytest

from vision_robot.arm import read_arm
from vision_robot.errors import BadArm, MissingLimits
from vision_robot.sim.gl import load_mujoco

HALF, WHOLE = "1.570796326794897", "3.14159265359"
JOINTS = (
    ("shoulder_pan_joint", "base_link", "l1", "0 0 0.1625", "0 0 0", 6.28),
    ("shoulder_lift_joint", "l1", "l2", "0 0 0", f"{HALF} 0 0", 6.28),
    ("elbow_joint", "l2", "l3", "-0.425 0 0", "0 0 0", 3.14),
    ("wrist_1_joint", "l3", "l4", "-0.3922 0 0.1333", "0 0 0", 6.28),
    ("wrist_2_joint", "l4", "l5", "0 -0.0997 0", f"{HALF} 0 0", 6.28),
    ("wrist_3_joint", "l5", "l6", "0 0.0996 0", f"{HALF} {WHOLE} {WHOLE}", 6.28),
)
"""The numbers of Universal Robots' own description of the UR5e."""

INERTIA = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
MESH = '<visual><geometry><mesh filename="package://none/l1.dae"/></geometry></visual>'


def ur5e() -> str:
    links = [
        f'<link name="{name}"><inertial><mass value="1"/>{INERTIA}</inertial></link>'
        for name in ("l1", "l2", "l3", "l4", "l5", "l6", "tool0")
    ]
    joints = [
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="0 0 1"/>'
        f'<limit lower="-{most}" upper="{most}" effort="1" velocity="1"/></joint>'
        for name, parent, child, xyz, rpy, most in JOINTS
    ]
    flange = (
        '<joint name="flange" type="fixed"><parent link="l6"/><child link="tool0"/>'
        '<origin xyz="0.01 0 0.02" rpy="0.1 0.2 0.3"/></joint>'
    )
    return f'<robot name="ur5e"><link name="base_link"/>{"".join(links + joints)}{flange}</robot>'


def written(tmp_path, text: str):
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    return path


def test_a_real_robot_agrees_with_mujocos_reading(tmp_path):
    text = ur5e()
    path = written(tmp_path, text)
    arm = read_arm(path)
    assert (arm.name, arm.base, arm.tool) == ("ur5e", "base_link", "tool0")
    mujoco = load_mujoco(rendering=False)
    spec = mujoco.MjSpec.from_file(str(path))
    spec.compiler.fusestatic = False
    model = spec.compile()
    data = mujoco.MjData(model)
    for q in np.random.default_rng(0).uniform(*arm.chain.limits.T, size=(200, 6)):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        for pose, body in ((arm.chain.base_from_tool(q), "tool0"), (arm.chain.base_from_wrist(q), "l6")):
            assert np.abs(pose.translation - data.body(body).xpos).max() < 1e-12
            assert np.abs(pose.rotation.ravel() - data.body(body).xmat).max() < 1e-12


def test_meshes_are_not_looked_for(tmp_path):
    text = ur5e().replace('<link name="l1">', f'<link name="l1">{MESH}')
    assert len(read_arm(written(tmp_path, text))) == 6


def test_wrist_and_base_by_name(tmp_path):
    path = written(tmp_path, ur5e())
    whole = read_arm(path).chain
    q = np.linspace(-1, 1, 6)
    at_tool = read_arm(path, wrist="tool0").chain
    assert np.allclose(at_tool.base_from_wrist(q).translation, whole.base_from_tool(q).translation)
    part = read_arm(path, base="l1")
    assert part.chain.joint_names[0] == "shoulder_lift_joint"
    assert part.base == "l1"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            'type="revolute"><parent link="l2"',
            'type="floating"><parent link="l2"',
            "'elbow_joint' is 'floating'",
        ),
        (
            '<axis xyz="0 0 1"/><limit lower="-3.14"',
            '<mimic joint="wrist_1_joint"/><limit lower="-3.14"',
            "'elbow_joint' follows joint 'wrist_1_joint'",
        ),
        (
            '<axis xyz="0 0 1"/><limit lower="-3.14"',
            '<axis xyz="0 0 0"/><limit lower="-3.14"',
            "the axis of joint 'elbow_joint'",
        ),
        ("-0.425 0 0", "-0.425 0", "xyz of joint 'elbow_joint' is '-0.425 0'"),
        ("-0.425 0 0", "-0.425 nan 0", "xyz of joint 'elbow_joint'"),
        ('lower="-3.14"', 'lower="5"', "the least comes first"),
        (
            '<child link="tool0"/>',
            '<child link="l2"/>',
            "closed chain: link 'l2' hangs on more than one joint",
        ),
        ('<parent link="base_link"/>', '<parent link="l3"/>', "closed chain|carries itself"),
        ("<robot name", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name', None),
        ('<child link="l3"/>', "<child/>", "joint 'elbow_joint' names no child link"),
    ],
)
def test_what_cannot_be_used_is_named(tmp_path, old, new, said):
    text = ur5e()
    assert old in text
    path = written(tmp_path, text.replace(old, new))
    if said is None:
        assert len(read_arm(path)) == 6
        return
    with pytest.raises(BadArm, match=said):
        read_arm(path)


def test_a_xacro_is_to_be_expanded_first(tmp_path):
    text = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="a"/></robot>'
    with pytest.raises(BadArm, match="expand it first"):
        read_arm(written(tmp_path, text))


def test_missing_limits_are_said(tmp_path):
    text = ur5e().replace('<limit lower="-3.14" upper="3.14" effort="1" velocity="1"/>', "")
    assert "elbow_joint has no limits" in read_arm(written(tmp_path, text)).assumed[0]
    sliding = text.replace('name="elbow_joint" type="revolute"', 'name="elbow_joint" type="prismatic"')
    with pytest.raises(MissingLimits, match="elbow_joint slide without limits"):
        read_arm(written(tmp_path, sliding))


def test_a_link_that_is_not_there_lists_those_that_are(tmp_path):
    with pytest.raises(BadArm, match=r"no link 'hand'; it has base_link, l1"):
        read_arm(written(tmp_path, ur5e()), tool="hand")
