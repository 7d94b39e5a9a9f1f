"""An arm of another make: two upright axes, a slide, a turning tool, and fingers that close along y."""

__all__ = ["SCARA"]

SCARA = """
<mujoco model="scara">
  <compiler angle="degree" autolimits="true"/>
  <option jacobian="dense"/>
  <default>
    <geom contype="0" conaffinity="0"/>
    <default class="pad"><geom contype="1" conaffinity="1" friction="1.1 0.01 0.0005" condim="4"/></default>
  </default>
  <worldbody>
    <body name="foot">
      <geom type="cylinder" size="0.06 0.17" pos="0 0 0.17" mass="5"/>
      <body name="inner" pos="0 0 0.36">
        <joint name="shoulder" axis="0 0 1" range="-160 160" damping="1" armature="0.05"/>
        <geom type="box" size="0.15 0.03 0.02" pos="0.15 0 0" mass="1"/>
        <body name="outer" pos="0.3 0 0">
          <joint name="elbow" axis="0 0 1" range="-150 150" damping="1" armature="0.05"/>
          <geom type="box" size="0.13 0.025 0.02" pos="0.13 0 0.01" mass="0.7"/>
          <body name="quill" pos="0.26 0 -0.06">
            <joint name="lift" type="slide" axis="0 0 1" range="-0.22 0.05" damping="20" armature="0.1"/>
            <geom type="cylinder" size="0.012 0.1" pos="0 0 0.06" mass="0.3"/>
            <body name="gripper" quat="0 1 0 0">
              <joint name="spin" axis="0 0 1" range="-200 200" damping="0.5" armature="0.02"/>
              <geom type="box" size="0.014 0.04 0.006" pos="0 0 0.04" mass="0.1"/>
              <site name="grasp_point" pos="0 0 0.1" size="0.004"/>
              {fingers}
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="m1" joint="shoulder" kp="3000" dampratio="1" ctrlrange="-160 160"/>
    <position name="m2" joint="elbow" kp="1500" dampratio="1" ctrlrange="-150 150"/>
    <position name="m3" joint="lift" kp="20000" dampratio="1" ctrlrange="-0.22 0.05"/>
    {spin}
    {drive}
  </actuator>
  {equality}
</mujoco>
"""

FINGERS = """
              <body name="jaw1" pos="0 -0.002 0.05">
                <joint name="jaw1" type="slide" axis="0 -1 0" range="0 {stroke}" damping="4" armature="0.05"/>
                <geom class="pad" type="box" size="0.008 0.004 0.026" pos="0 -0.004 0.026" mass="0.02"/>
              </body>
              <body name="jaw2" pos="0 0.002 0.05">
                <joint name="jaw2" type="slide" axis="0 1 0" range="0 {stroke}" damping="4" armature="0.05"/>
                <geom class="pad" type="box" size="0.008 0.004 0.026" pos="0 0.004 0.026" mass="0.02"/>
              </body>
"""

JAWS = """<equality><joint joint1="jaw1" joint2="jaw2" polycoef="0 1 0 0 0" solref="0.004 1"/></equality>"""
SPIN = """<position name="m4" joint="spin" kp="150" dampratio="1" ctrlrange="-200 200"/>"""


def scara(*, gripper: bool = True, stroke_m: float = 0.03, servos: bool = True) -> str:
    """The file's text: without a gripper, with a narrow one, or with a motor in the place of a servo."""
    drive = '<position name="jaws" joint="jaw1" kp="1500" kv="30" ctrlrange="0 {}" forcerange="-15 15"/>'
    return SCARA.format(
        fingers=FINGERS.format(stroke=stroke_m) if gripper else "",
        spin=SPIN if servos else "",
        drive=drive.format(stroke_m) if gripper else "",
        equality=JAWS if gripper else "",
    )
