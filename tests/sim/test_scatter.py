"""Scattered items keep apart, stay in their region, and are the same for the same seed."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.sim.cell_design import Item
from vision_robot.sim.scatter import apart, outline, scattered

REGION = (-0.15, -0.2, 0.15, 0.2)
ITEMS = [Item(f"p{i}") for i in range(8)] + [
    Item("b", "box", (0.04, 0.04, 0.02)),
    Item("d", "disc", (0.05, 0.01)),
]


def test_they_keep_apart_and_stay_inside():
    first = scattered(ITEMS, REGION, np.random.default_rng(3))
    again = scattered(ITEMS, REGION, np.random.default_rng(3))
    other = scattered(ITEMS, REGION, np.random.default_rng(4))
    assert first == again
    assert first != other
    outlines = [outline(i, i.x_m, i.y_m, i.yaw_rad) for i in first]
    for k, one in enumerate(outlines):
        assert all(apart(one, two) >= 0.01 for two in outlines[:k])
    assert all(abs(i.x_m) <= 0.15 and abs(i.y_m) <= 0.2 for i in first)


def test_what_stands_already_is_kept_clear_of():
    wall = Item("wall", "box", (0.3, 0.1, 0.02))
    for item in scattered(ITEMS[:3], REGION, np.random.default_rng(0), around=[wall]):
        assert apart(outline(item, item.x_m, item.y_m, item.yaw_rad), outline(wall, 0, 0, 0)) >= 0.01


def test_distance_of_rectangles():
    square = Item("s", "box", (0.02, 0.02, 0.02))
    assert apart(outline(square, 0, 0, 0), outline(square, 0.05, 0, 0)) == pytest.approx(0.03)
    assert apart(outline(square, 0, 0, 0), outline(square, 0.05, 0, np.pi / 4)) == pytest.approx(
        0.04 - 0.01 * 2**0.5
    )
    assert apart(outline(square, 0, 0, 0.3), outline(square, 0.01, 0, 1.0)) < 0


def test_no_room_is_said():
    with pytest.raises(BadParameter, match="more room"):
        scattered(ITEMS, (-0.01, -0.01, 0.01, 0.01), np.random.default_rng(0))
