"""Things on a belt: their motion is told from sightings, and the gripper meets and follows them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_robot.errors import BadParameter
from vision_robot.pick.conveyor import CATCH_UP_S, CLOSE_S, DOWN_S, UP_S, Motion, fitted, led
from vision_robot.pick.episodes import Plan, run_episode
from vision_robot.pick.scenes import SCENES, scene_named
from vision_robot.sim.cell_design import Item, Lights

RED = {"color": "red"}
MOTION = Motion(1.0, np.array([0.02, -0.1]), np.array([0.0, 0.08]), 1e-4, 0.3)


def without_shadows(world):
    return replace(world, design=replace(world.design, lights=Lights(shadows=False)))


@given(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(-1.5, 1.5))
def test_an_even_motion_is_found_exactly(vx, vy, yaw):
    times = np.linspace(2.0, 3.0, 7)
    places = np.array([0.1, -0.2]) + times[:, None] * np.array([vx, vy])
    found = fitted(times, places, np.full(7, yaw) + np.pi * np.arange(7))  # headless: half turns do not count
    assert np.allclose(found.at(5.0), [0.1 + 5 * vx, -0.2 + 5 * vy])
    assert np.allclose(found.velocity_m_s, [vx, vy])
    assert found.sigma_m < 1e-12
    assert abs((found.yaw_rad - yaw + np.pi / 2) % np.pi - np.pi / 2) < 1e-9


def test_the_tool_is_at_rest_then_with_the_thing_then_at_rest():
    start, step = 2.0, 1e-5

    def rate(after):
        return (led(MOTION, start, after + step) - led(MOTION, start, after - step)) / (2 * step)

    assert np.allclose(rate(2 * step), 0, atol=1e-4)
    for after in (CATCH_UP_S, CATCH_UP_S + DOWN_S, CATCH_UP_S + DOWN_S + CLOSE_S):
        assert np.allclose(led(MOTION, start, after), MOTION.at(start + after))
        assert np.allclose(rate(after), MOTION.velocity_m_s, atol=1e-4)
    assert np.allclose(rate(CATCH_UP_S + DOWN_S + CLOSE_S + UP_S), 0, atol=1e-4)


def test_a_rod_that_rides_past_is_picked_and_put_down_beside_the_belt():
    episode = run_episode(without_shadows(scene_named("conveyor")), Plan(options=RED), seed=1)
    assert episode.failure is None
    assert episode.rung == "placed"
    assert episode.closing is not None
    assert episode.closing.position_m < 0.003
    assert episode.station_from_place.translation[0] > 0.1


def test_what_is_too_fast_is_let_go_and_counted():
    world = without_shadows(scene_named("conveyor", belt_speed_m_s=0.5))
    episode = run_episode(world, Plan(options=RED), seed=1)
    assert episode.cause in ("gone by", "out of sight")
    assert not episode.gripped


def test_scenes_by_name_and_what_they_have_no_use_for():
    assert scene_named("clutter").design.items[1:]
    with pytest.raises(BadParameter, match="conveyor"):
        scene_named("moon")
    with pytest.raises(BadParameter, match="no belt"):
        scene_named("table", belt_speed_m_s=0.1)
    with pytest.raises(BadParameter, match="positive"):
        scene_named("conveyor", belt_speed_m_s=-0.1)
    with pytest.raises(BadParameter, match="one at a time"):
        scene_named("conveyor", [Item("a", "disc", (0.03, 0.01)), Item("b", "disc", (0.03, 0.01))])
    assert all(kind.meaning for kind in SCENES.values())


def test_closed_loops_want_things_that_lie_still():
    with pytest.raises(BadParameter, match="belt"):
        run_episode(without_shadows(scene_named("conveyor")), Plan(options=RED, loop="position"), seed=0)
