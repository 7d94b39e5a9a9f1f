"""Whole episodes in MuJoCo's physics: what succeeds, what faults cost, and what closing the loop gives."""

from dataclasses import replace

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.evaluate.attribution import attribute, subsets
from vision_robot.geometry import SE3
from vision_robot.pick.budget import closing_errors
from vision_robot.pick.episodes import Plan, run_episode
from vision_robot.pick.knowledge import STAGES
from vision_robot.pick.world import ordinary_world

WORLD = ordinary_world(shadows=False)
RED = {"color": "red"}
KNOCKED = replace(WORLD, knock=SE3.from_rotvec(np.radians([0.6, 0.4, 0.0]), np.zeros(3)))


def test_open_loop_picks_and_places_with_a_calibrated_cell():
    episode = run_episode(WORLD, Plan(options=RED), seed=1)
    assert episode.rung == "placed"
    assert episode.closing is not None
    assert episode.placing is not None
    assert episode.closing.position_m < 0.002
    assert abs(episode.closing.yaw_rad) < np.radians(2)
    assert episode.placing.position_m < 0.003
    assert episode.failure is None


def test_the_same_seed_gives_the_same_episode():
    assert run_episode(WORLD, Plan(options=RED), seed=4) == run_episode(WORLD, Plan(options=RED), seed=4)


def test_closing_the_loop_gives_back_what_a_knocked_camera_costs():
    open_loop = run_episode(KNOCKED, Plan(options=RED), seed=0)
    closed = run_episode(KNOCKED, Plan(options=RED, loop="look-move-look"), seed=0)
    assert open_loop.closing is not None
    assert closed.closing is not None
    assert open_loop.closing.position_m > 0.005
    assert closed.closing.position_m < 0.4 * open_loop.closing.position_m
    assert closed.looks > 2


def test_background_subtraction_sees_what_arrives():
    episode = run_episode(WORLD, Plan(tracker="background"), seed=2)
    assert episode.seen_error_m < 0.003
    assert episode.rung == "placed"


def test_what_is_not_seen_is_not_picked():
    episode = run_episode(WORLD, Plan(options={"color": "green"}), seed=0)
    assert episode.rung == ""
    assert "does not see" in str(episode.failure)


def test_the_error_budget_adds_up_and_finds_the_fault():
    """With a camera knocked by half a degree nearly all of the error is the plane's."""
    errors = closing_errors(KNOCKED, Plan(options=RED), [0], list(subsets(STAGES)))
    found = attribute(STAGES, {true: float(np.hypot(*miss[0, :2])) for true, miss in errors.items()})
    assert sum(found.share.values()) == pytest.approx(found.total - found.floor)
    assert found.share["plane"] > 0.7 * found.total
    assert found.floor < 1e-4


def test_an_unknown_loop_is_refused():
    with pytest.raises(BadParameter, match="look-move-look"):
        Plan(loop="blind")
