"""The label is found where it really is, and never when something covers part of it."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from vision_robot.arm.ik import InverseKinematics
from vision_robot.pick.hand_label import LABEL_SIGMA_PX, label_of, seen_whole
from vision_robot.pick.look import Eye
from vision_robot.pick.player import Player
from vision_robot.pick.servo.hand import Hand
from vision_robot.pick.sighting import Sighting
from vision_robot.pick.world import ordinary_world
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_model import LABEL
from vision_robot.track.blob_analysis import analyse
from vision_robot.track.registry import tracker_named

CORNERS = np.array([[100.0, 80.0], [150.0, 95.0], [138.0, 140.0], [88.0, 125.0]])
HEIGHTS = (0.15, 0.02)


def drawn(corners, hidden=None):
    """Blobs of a filled polygon, a part of it painted over."""
    mask = np.zeros((240, 320), np.uint8)
    cv2.fillPoly(mask, [np.round(corners * 256).astype(np.int32)], 255, shift=8)
    if hidden is not None:
        mask[:, : int(hidden)] = 0
    return analyse(mask > 0)


def test_a_whole_label_is_where_its_corners_are():
    found = seen_whole(drawn(CORNERS), CORNERS)
    assert found is not None
    assert np.allclose(found, CORNERS.mean(axis=0), atol=0.1)


@pytest.mark.parametrize("share", [0.92, 1.08])
def test_a_camera_nearer_or_farther_off_than_believed_changes_nothing(share):
    middle = CORNERS.mean(axis=0)
    assert seen_whole(drawn(middle + share * (CORNERS - middle)), CORNERS) is not None


@pytest.mark.parametrize("hidden", [96, 110, 130, 149, 320])
def test_a_label_covered_in_part_or_altogether_is_not_taken(hidden):
    assert seen_whole(drawn(CORNERS, hidden), CORNERS) is None


def test_in_the_cell_it_is_seen_in_the_clearest_way_and_where_it_really_is():
    """Places all over the table, at both heights: three of its stated sigmas against the truth."""
    world = replace(ordinary_world(shadows=False), frame_rate=30.0)
    cell = Cell(world.design)
    player = Player(cell, world, InverseKinematics(world.arm))
    mount = world.design.arm
    assert mount is not None
    label, off = label_of(world.arm, mount), []
    rng = np.random.default_rng(4)
    with Eye(cell, world, 0) as eye:
        for _ in range(6):
            place = rng.uniform((-0.1, -0.13), (0.08, 0.13))
            thing = Sighting(place, np.zeros((2, 2)), float(rng.uniform(-1.5, 1.5)), 0.005)
            tracker = tracker_named("rgb", {"color": "pink"})
            first = Hand(player, eye, tracker, world.truth, label)
            way = max(
                first.ways(thing, HEIGHTS[-1]),
                key=lambda one: min(one.clearance_m(thing, h) for h in HEIGHTS),
            )
            for height in HEIGHTS:
                joints = way.joints(thing, height)
                cell.pose_arm(joints)
                corners = label.corners_px(world.truth, joints)
                seen = seen_whole(tracker_named("rgb", {"color": "pink"}).step(eye.picture(), 0.0), corners)
                assert seen is not None
                off.append(seen - eye.truth_of(LABEL).centroid_px)
    assert np.abs(off).max() < 3 * LABEL_SIGMA_PX
    assert np.sqrt(np.mean(np.square(off))) < 1.2 * LABEL_SIGMA_PX
