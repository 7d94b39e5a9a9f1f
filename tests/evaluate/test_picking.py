"""Episodes together: vectors from misses, ISO 9283, groups that lose nobody."""

import numpy as np
import pytest

from tests.picked import GOAL, WORLD, episode
from vision_robot.evaluate.picking import (
    by_distance,
    by_thing,
    by_yaw,
    closing_offsets_m,
    distance_from_centre,
    iso_9283,
    ladder,
    placing_offsets_m,
)
from vision_robot.pick.episode import Miss, miss_of

RNG = np.random.default_rng(0)


def test_offsets_are_in_the_station_whatever_the_yaw():
    some = [episode(yaw=yaw, off=(0.001, -0.002)) for yaw in np.linspace(-3, 3, 7)]
    assert np.allclose(closing_offsets_m(some), [0.001, -0.002])
    placed = miss_of(GOAL, GOAL.translation + np.array([0.003, 0.001, 0]), np.pi / 2)
    assert np.allclose(placing_offsets_m([episode(placing=placed), episode()]), [[0.003, 0.001]])
    assert closing_offsets_m([]).shape == (0, 2)


def test_iso_9283_of_a_bias_and_of_a_spread():
    biased = iso_9283([Miss(0.002, 0.0, 0.1, 0.01)] * 5)
    assert biased is not None
    assert biased.accuracy_m == pytest.approx(0.002)
    assert biased.repeatability_m == pytest.approx(0, abs=1e-12)
    assert biased.yaw_accuracy_rad == pytest.approx(0.01)
    assert iso_9283([Miss(0, 0, 0, 0)]) is None


def test_the_ladder_counts_and_knows_how_surely():
    some = [episode(reached=True, gripped=True, lifted=True)] * 3 + [episode()]
    rungs = ladder(some)
    assert [rungs[name].value for name in ("seen", "reached", "lifted", "placed")] == [1, 0.75, 0.75, 0]
    assert rungs["lifted"].low == pytest.approx(0.301, abs=2e-3)  # Wilson 1927


def test_groups_hold_every_episode_once():
    some = [
        episode(k, *RNG.uniform(-0.1, 0.1, 2), yaw=RNG.uniform(-np.pi, np.pi), lifted=bool(k % 2))
        for k in range(60)
    ]
    for groups in (by_distance(WORLD, some), by_yaw(some), by_thing(some)):
        assert sum(group.grasps.n for group in groups) == 60
        assert sum(group.grasps.value * group.grasps.n for group in groups) == pytest.approx(30)


def test_distance_is_zero_in_the_middle_of_the_picture():
    view = WORLD.view_now
    middle = (np.array([[view.camera.width, view.camera.height]]) - 1) / 2
    x, y = WORLD.truth.plane.measure(middle, z_m=0.005)[0][0]
    assert distance_from_centre(WORLD, episode(x=x, y=y)) == pytest.approx(0, abs=1e-6)
    assert distance_from_centre(WORLD, episode(x=x + 0.1, y=y)) > 0.2
