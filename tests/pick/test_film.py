"""A film shows every phase, changes nothing of the episode, and tells also when nothing is seen."""

from dataclasses import replace

import numpy as np

from vision_robot.geometry import Camera
from vision_robot.pick.episodes import Plan, run_episode
from vision_robot.pick.film import Film, Stills, film_size
from vision_robot.pick.world import ordinary_world
from vision_robot.video import Video, VideoWriter

SMALL = Camera(320, 240, 351.2, 350.4, 160.0, 119.0)
WORLD = ordinary_world(camera=SMALL, shadows=False)
PLAN = Plan(options={"color": "red"})


def test_a_filmed_episode_is_the_same_episode(tmp_path):
    place = tmp_path / "pick.mp4"
    with VideoWriter(place, film_size(SMALL), 4) as video:
        filmed = run_episode(WORLD, PLAN, 1, witness=Film(video.write, 4))
    assert filmed == run_episode(WORLD, PLAN, 1)
    seconds = len(list(Video(place))) / 4
    assert filmed.seconds < seconds < filmed.seconds + 3


def test_stills_are_one_of_each_phase_and_marks_lie_on_the_thing():
    stills = Stills()
    episode = run_episode(WORLD, PLAN, 1, witness=stills)
    phases = [still.phase for still in stills.pictures]
    assert phases == [
        "seen", "open", "above", "down", "close", "lift", "carry", "put down", "placed",
    ]  # fmt: skip
    times = [still.time_s for still in stills.pictures]
    assert times == sorted(times)
    pose = WORLD.view.cam_from_station @ episode.station_from_object
    u, v = SMALL.project(pose.apply(np.zeros((1, 3))))[0]
    around = stills.pictures[0].image[round(v) - 8 : round(v) + 9, round(u) - 8 : round(u) + 9].astype(int)
    marked = (np.abs(around - (0, 140, 255)).sum(axis=2) < 60).sum()
    assert marked > 8  # the strokes of the cross, in the colour of what was seen


def test_looks_of_a_closed_loop_stand_in_the_film_and_in_the_episode():
    episode = run_episode(ordinary_world(shadows=False), replace(PLAN, loop="look-move-look"), 2)
    assert len(episode.course) == episode.looks - 1
    errors = [look.error_m for look in episode.course]
    assert errors[0] > 0
    assert np.isfinite([look.true_m for look in episode.course]).all()
    heights = [look.height_m for look in episode.course]
    assert heights[0] > heights[-1]


def test_an_empty_look_is_filmed_too():
    frames, stills = [], Stills()
    blind = replace(PLAN, options={"color": "green"})
    run_episode(WORLD, blind, 0, witness=Film(frames.append, 10))
    run_episode(WORLD, blind, 0, witness=stills)
    assert len(frames) == 15
    assert [still.phase for still in stills.pictures] == ["nothing seen"]
