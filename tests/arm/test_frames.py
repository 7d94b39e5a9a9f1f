"""The frames algebra: the tool stands on the goal."""

import numpy as np

from vision_robot.arm import base_from_tool, base_from_wrist
from vision_robot.geometry import SE3

RNG = np.random.default_rng(2)


def test_the_wrist_that_the_algebra_gives_brings_the_tool_to_the_goal():
    base_from_station, station_from_goal, wrist_from_tool = (SE3.exp(RNG.normal(size=6)) for _ in range(3))
    wrist = base_from_wrist(base_from_station, station_from_goal, wrist_from_tool)
    tool = wrist @ wrist_from_tool
    goal = base_from_station @ station_from_goal
    assert np.allclose(tool.as_matrix(), goal.as_matrix())
    assert np.allclose(base_from_tool(base_from_station, station_from_goal).as_matrix(), goal.as_matrix())
