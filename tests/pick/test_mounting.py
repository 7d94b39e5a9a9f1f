"""An arm of one's own: what it lacks is said in a line, and one that has all of it picks."""

from dataclasses import replace

import numpy as np
import pytest

from tests.pick.scara import scara
from vision_robot.errors import BadArm
from vision_robot.pick.episodes import Plan, run_episode
from vision_robot.pick.mounting import with_arm
from vision_robot.pick.world import ordinary_world
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import Item

WORLD = ordinary_world(shadows=False)


def mounted(tmp_path, tool="grasp_point", **kind):
    path = tmp_path / "scara.xml"
    path.write_text(scara(**kind))
    return with_arm(WORLD, str(path), tool=tool)


def test_joints_fingers_and_a_place_for_the_table_are_found(tmp_path):
    world = mounted(tmp_path)
    assert world.arm.chain.joint_names == ("shoulder", "elbow", "lift", "spin")
    cell = Cell(world.design)
    fingers = cell.fingers
    assert fingers is not None
    assert np.allclose(
        np.abs(fingers.closing), [1, 0], atol=1e-9
    )  # x is where they close, whatever the file says
    assert cell.opening_limits_m == pytest.approx((0.004, 0.064), abs=1e-6)
    assert cell.opening_m == pytest.approx(0.064, abs=1e-6)
    # Chain and physics speak of the same tool.
    believed = world.arm.chain.base_from_tool(cell.joints)
    assert np.allclose(believed.as_matrix(), cell.base_from_tool.as_matrix(), atol=1e-9)


def test_it_picks_and_places(tmp_path):
    episode = run_episode(mounted(tmp_path), Plan(options={"color": "red"}), seed=3)
    assert episode.failure is None
    assert episode.rung == "placed"
    assert episode.closing is not None
    assert episode.closing.position_m < 0.002


def test_a_thing_too_wide_for_its_gripper_ends_the_episode(tmp_path):
    brick = Item("brick", "box", (0.07, 0.06, 0.02), colour=(0.82, 0.14, 0.10))
    world = mounted(tmp_path)
    world = replace(world, design=replace(world.design, items=(brick,)))
    episode = run_episode(world, Plan(options={"color": "red"}), seed=3)
    assert episode.cause == "gripper too narrow"
    assert episode.seen


@pytest.mark.parametrize(
    ("kind", "says"),
    [
        ({"gripper": False}, "has no gripper"),
        ({"servos": False}, "spin"),
        ({"tool": "hand"}, "grasp_point"),
        ({"tool": "gripper"}, "mark the place between the fingers by a site"),
    ],
)
def test_what_it_lacks_is_said(tmp_path, kind, says):
    with pytest.raises(BadArm, match=says):
        mounted(tmp_path, **kind)


def test_a_urdf_has_no_gripper_drive(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text("<robot name='r'/>")
    with pytest.raises(BadArm, match="MJCF"):
        with_arm(WORLD, str(path))
