"""Collisions as MuJoCo finds them: fingers in a table, and nothing in the air."""

import numpy as np
import pytest

from vision_robot.arm import read_arm
from vision_robot.arm.collision import free_of_collision
from vision_robot.errors import BadArm

ARM = """<mujoco><worldbody><geom name="table" type="box" size="1 1 0.1" pos="0 0 -0.1"/>
<body name="a" pos="0 0 0.5"><joint name="down" type="slide" axis="0 0 -1" range="0 1"/><geom size="0.1"/>
<site name="tool"/></body>
<body name="loose" pos="0.5 0 0.05"><freejoint/><geom size="0.06"/></body></worldbody></mujoco>"""


def test_only_the_arm_counts(tmp_path):
    """A thing that lies on the table touches it too: that is not the arm's affair."""
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    arm = read_arm(path)
    free = free_of_collision(path, arm.chain.joint_names, np.array([[0.0], [0.39], [0.41]]))
    assert free.tolist() == [True, True, False]


def test_joints_it_does_not_have_are_named(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    with pytest.raises(BadArm, match="no joint 'up'; it has down"):
        free_of_collision(path, ("up",), np.zeros((1, 1)))
