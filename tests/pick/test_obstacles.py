"""Other things on the table: grasps keep clear of them, and what blocks all of them goes first."""

from dataclasses import replace

import numpy as np
import pytest

from vision_robot.arm.ik import InverseKinematics
from vision_robot.errors import GripperTooNarrow, InTheWay
from vision_robot.geometry import SE3
from vision_robot.pick.attempt import Attempt
from vision_robot.pick.grasps import Target, around, footprint_of, grasps_of, symmetry_of
from vision_robot.pick.look import Eye
from vision_robot.pick.obstacles import Obstacle, free_target
from vision_robot.pick.player import Player
from vision_robot.pick.sighting import Sighting
from vision_robot.pick.world import ROD, ordinary_world
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import Item
from vision_robot.sim.cell_model import resting
from vision_robot.sim.fingers import Fingers
from vision_robot.sim.scatter import apart
from vision_robot.track.registry import tracker_named

FINGERS = Fingers(0.076, 0.009, 0.018, 0.0035, np.array([1.0, 0.0]))
MOST_M = 0.076
BOX = Item("box", "box", (0.05, 0.03, 0.02), colour=(0.82, 0.14, 0.10))
BAR = Item("bar", "box", (0.11, 0.01, 0.012), colour=(0.12, 0.28, 0.72))
CUBE = Item("cube", "box", (0.025, 0.018, 0.012), colour=(0.15, 0.55, 0.22))


def lying(x, y, yaw=0.0, height=0.005):
    return Sighting(np.array([x, y]), np.zeros((2, 2)), yaw, height)


def test_the_fingers_of_the_own_arm_are_what_its_file_says():
    fingers = Cell(ordinary_world().design).fingers
    assert fingers is not None
    assert fingers.gap_m == pytest.approx(0.076)
    assert fingers.thickness_m == pytest.approx(0.009)
    assert fingers.breadth_m == pytest.approx(0.018)
    assert fingers.tip_m == pytest.approx(0.0035)


def test_a_rod_is_taken_in_its_middle_across_its_axis():
    best = grasps_of(ROD, FINGERS, MOST_M)[0]
    assert best.offset_m == (0, 0)
    assert best.turn_rad == 0
    assert best.width_m == pytest.approx(0.01)
    assert best.opening_m == pytest.approx(0.036)


def test_a_box_is_taken_across_its_narrow_side_first():
    grasps = grasps_of(BOX, FINGERS, MOST_M)
    assert grasps[0].width_m == pytest.approx(0.03)
    assert any(abs(one.turn_rad - np.pi / 2) < 1e-9 and one.width_m == pytest.approx(0.05) for one in grasps)


def test_fingers_stay_off_the_table():
    thin = Item("sheet", "box", (0.05, 0.03, 0.002))
    assert grasps_of(thin, FINGERS, MOST_M)[0].height_m > FINGERS.tip_m


def test_what_is_too_wide_is_said_with_its_width():
    with pytest.raises(GripperTooNarrow, match="80 mm, the fingers open to 76 mm"):
        grasps_of(Item("brick", "box", (0.09, 0.08, 0.02)), FINGERS, MOST_M)


@pytest.mark.parametrize(("item", "turn"), [(ROD, np.pi), (BOX, np.pi), (CUBE, np.pi)])
def test_a_grasp_off_the_middle_is_measured_on_its_own_side(item, turn):
    """Seen the other way round, the same grasp is the same place of the body."""
    grasp = grasps_of(item, FINGERS, MOST_M)[1]
    pose = resting(item, np.array([0.03, 0.02, 0.0, 0.4]))
    seen = Target(lying(0.03, 0.02, 0.4), grasp, symmetry_of(item))
    other = Target(lying(0.03, 0.02, 0.4 + turn), grasp, symmetry_of(item))
    assert np.allclose(seen.axis_of(pose).translation[:2], seen.aim.position_m)
    assert np.allclose(other.axis_of(pose).translation[:2], other.aim.position_m)


def test_a_disc_has_no_direction_and_many_grasps():
    disc = Item("disc", "disc", (0.04, 0.01))
    assert symmetry_of(disc) == 0
    assert len({one.turn_rad for one in grasps_of(disc, FINGERS, MOST_M)}) == 12


def test_a_grasp_that_touches_nothing_is_chosen():
    beside = Obstacle(lying(0.0, 0.025), (0.03, 0.01))
    target = free_target("rod", lying(0, 0), grasps_of(ROD, FINGERS, MOST_M), np.pi, FINGERS, [beside])
    assert target.grasp.offset_m[0] != 0
    assert apart(around(target, FINGERS), beside.corners) >= 0.003


def test_where_no_grasp_is_free_the_reason_has_its_place():
    along = Obstacle(lying(0.0, 0.022), (0.2, 0.01))
    with pytest.raises(InTheWay, match=r"\(0, 22\) mm"):
        free_target("rod", lying(0, 0), grasps_of(ROD, FINGERS, MOST_M), np.pi, FINGERS, [along])


def attempt_on(eye, cell, world):
    player = Player(cell, world, InverseKinematics(world.arm))
    return Attempt(eye, player, world.truth, tracker_named("rgb", {"color": ("red", "blue", "green")}))


def test_what_blocks_every_grasp_is_put_aside_first():
    """A bar along one side and a block at one end: neither side of the box is free."""
    world = ordinary_world(BOX, BAR, CUBE, shadows=False)
    cell = Cell(world.design)
    for item, place in ((BOX, (0, 0)), (BAR, (0, 0.028)), (CUBE, (0.045, 0.0))):
        cell.place(item.name, resting(item, np.array([*place, 0.0, 0.0])))
    cell.advance(0.2)
    with Eye(cell, replace(world, image_noise=0.5), 0) as eye:
        attempt = attempt_on(eye, cell, world)
        where = attempt.found()
        assert len(attempt.obstacles) == 2
        sizes = sorted(one.size_m[0] for one in attempt.obstacles)
        assert sizes == pytest.approx([footprint_of(CUBE)[0], footprint_of(BAR)[0]], rel=0.2)
        with pytest.raises(InTheWay):
            free_target("box", where, attempt.grasps, np.pi, attempt.fingers, attempt.obstacles)
        target, cleared = attempt.free(where)
    assert cleared == 1
    assert np.linalg.norm(target.where.position_m) < 0.002
    moved = [np.linalg.norm(cell.station_from(name).translation[:2]) for name in ("bar", "cube")]
    assert max(moved) > 0.06
    assert isinstance(cell.station_from("box"), SE3)
