"""MJCF: MuJoCo's own kinematics to 1e-12 m, and what is no serial chain named."""

import numpy as np
import pytest

from vision_robot.arm import read_arm
from vision_robot.errors import BadArm, MissingLimits
from vision_robot.sim.gl import load_mujoco

mujoco = load_mujoco(rendering=False)

AWKWARD = """
<mujoco model="awkward">
  <compiler angle="degree" eulerseq="ZYX" autolimits="true"/>
  <default><default class="turn"><joint range="-100 120" axis="0 1 0.2"/></default></default>
  <worldbody>
    <body name="table" pos="1 2 0.5" euler="20 0 30">
      <body name="foot" pos="0.1 0 0" euler="10 20 30">
        <body name="one" pos="0 0.1 0.2" childclass="turn">
          <joint name="a" pos="0.03 -0.02 0.1" ref="25"/>
          <joint name="b" axis="1 0 0.3" pos="0 0.05 0" range="-90 90"/>
          <geom size="0.01"/>
          <body name="two" pos="0.3 0 0.1" quat="0.9 0.1 0.3 -0.2">
            <joint name="c" type="slide" axis="0.2 0 1" range="-0.1 0.3" ref="0.07"/>
            <geom size="0.01"/>
            <body name="plate" pos="0 0.02 0.03" euler="0 45 0">
              <body name="three" pos="0.1 0.1 0">
                <joint name="d" axis="0 0 1" pos="0.01 0.02 0.03"/>
                <geom size="0.01"/>
                <body name="flange" pos="0 0 0.05" euler="5 6 7">
                  <site name="wrist" pos="0.01 0 0"/>
                  <body pos="0 0.1 0"><site name="tool" pos="0.2 0.1 0" euler="1 2 3"/></body>
                </body>
              </body>
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def written(tmp_path, text: str):
    path = tmp_path / "arm.xml"
    path.write_text(text)
    return path


def compare(path, arm, joints, base=None):
    """Greatest difference to MuJoCo over random joint values, poses of site `tool` in body `base`."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    rng, worst = np.random.default_rng(1), 0.0
    for q in rng.uniform(*arm.chain.limits.T, size=(200, len(arm))):
        for name, value in zip(joints, q, strict=True):
            data.joint(name).qpos[0] = value
        mujoco.mj_kinematics(model, data)
        for frame, pose in (
            ("tool", arm.chain.base_from_tool(q)),
            ("wrist", arm.chain.base_from_wrist(q)),
        ):
            site = data.site(frame)
            turn, shift = site.xmat.reshape(3, 3), site.xpos
            if base:
                body = data.body(base)
                turn = body.xmat.reshape(3, 3).T @ turn
                shift = body.xmat.reshape(3, 3).T @ (shift - body.xpos)
            worst = max(worst, np.abs(pose.translation - shift).max(), np.abs(pose.rotation - turn).max())
    return worst


def test_our_arm_agrees_with_mujoco():
    arm = read_arm("column")
    assert arm.chain.joint_names == ("d1", "theta2", "theta3", "theta4", "theta5")
    assert (arm.base, arm.tool, arm.assumed) == ("base", "tool", ())
    from importlib.resources import files

    path = files("vision_robot.arm") / "models/column_arm.xml"
    assert compare(path, arm, arm.chain.joint_names) < 1e-12


def test_refs_anchors_two_joints_a_body_and_crooked_frames_agree_with_mujoco(tmp_path):
    path = written(tmp_path, AWKWARD)
    arm = read_arm(path)
    assert arm.base == "foot"
    assert arm.chain.joint_names == ("a", "b", "c", "d")
    assert np.allclose(np.degrees(arm.chain.limits[[0, 3]]), [-100, 120])
    assert compare(path, arm, "abcd", base="foot") < 1e-12
    assert compare(path, read_arm(path, base="world"), "abcd") < 1e-12


def test_meshes_that_are_missing_are_no_obstacle(tmp_path):
    text = AWKWARD.replace("<worldbody>", '<asset><mesh name="m" file="none.stl"/></asset><worldbody>')
    path = written(tmp_path, text.replace('<geom size="0.01"/>', '<geom type="mesh" mesh="m"/>', 1))
    whole = read_arm(written(tmp_path / "..", AWKWARD)).chain
    assert np.array_equal(read_arm(path).chain.link_from_joint.translation, whole.link_from_joint.translation)


LOOP = """<mujoco><worldbody><body name="l1"><joint name="j1" axis="0 0 1" range="-1 1"/><geom size=".1"/>
<body name="l2" pos="1 0 0"><joint name="j2" axis="0 0 1" range="-1 1"/><geom size=".1"/><site name="tool"/>
</body></body><body name="l3" pos="1 1 0"><joint name="j3" axis="0 0 1"/><geom size=".1"/></body></worldbody>
<equality>{}</equality></mujoco>"""


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            LOOP.format('<connect name="shut" body1="l2" body2="l3" anchor="0 0 0"/>'),
            "'shut' closes a loop over .*'j1', 'j2'",
        ),
        (LOOP.format('<joint joint1="j1" joint2="j2"/>'), "closes a loop over .*'j1', 'j2'"),
        (
            LOOP.format("").replace('name="j2" axis="0 0 1" range="-1 1"', 'name="ball" type="ball"'),
            "'ball' is a ball joint",
        ),
        (
            LOOP.format("").replace('name="j1" axis="0 0 1" range="-1 1"', 'name="free" type="free"'),
            "'free' is a free joint",
        ),
        (
            LOOP.format("")
            .replace('name="tool"', 'name="tip"')
            .replace("</body></body>", '<site name="b"/></body></body>', 1),
            "which site is the tool.*tip, b.*--tool",
        ),
        (LOOP.format("").replace('<site name="tool"/>', ""), "it has no site: mark the tool"),
        ("<mujoco><worldbody><site name='tool'/></worldbody></mujoco>", "no joint moves 'tool'"),
        ("<mujoco><worldbody>", "no XML"),
        ("<mujoco><wordbody/></mujoco>", "wordbody"),
    ],
)
def test_what_is_no_serial_arm_is_named(tmp_path, text, said):
    with pytest.raises(BadArm, match=said):
        read_arm(written(tmp_path, text))


def test_a_site_that_is_not_there_lists_those_that_are(tmp_path):
    with pytest.raises(BadArm, match=r"no site 'tol'; it has wrist, tool"):
        read_arm(written(tmp_path, AWKWARD), tool="tol")


def test_a_loop_in_the_gripper_or_a_handle_for_the_mouse_is_not_the_arms(tmp_path):
    text = LOOP.format('<weld body1="l2" body2="hold"/>')
    text = text.replace("</worldbody>", '<body name="hold" mocap="true"/></worldbody>')
    assert len(read_arm(written(tmp_path, text))) == 2
    assert len(read_arm("column")) == 5  # its fingers are tied to each other


def test_missing_limits_are_said(tmp_path):
    turning = LOOP.format("").replace(' range="-1 1"', "", 1)
    arm = read_arm(written(tmp_path, turning))
    assert arm.assumed == ("joint j1 has no limits in the file: -180 to 180 deg are taken",)
    assert np.allclose(arm.chain.limits[0], [-np.pi, np.pi])
    sliding = turning.replace('name="j1"', 'name="j1" type="slide"')
    with pytest.raises(MissingLimits, match=r"j1 slide without limits.*--limit j1=0..0.4m"):
        read_arm(written(tmp_path, sliding))
    assert read_arm(written(tmp_path, sliding), limits={"j1": (0, 0.2)}).chain.limits[0].tolist() == [0, 0.2]


def test_a_file_that_is_not_there_names_the_arms_there_are(tmp_path):
    with pytest.raises(BadArm, match=r"no such file, nor an arm that comes with the tool \(column\)"):
        read_arm(tmp_path / "none.xml")
