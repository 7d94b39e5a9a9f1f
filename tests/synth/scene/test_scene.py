"""Scenes: things keep clear of each other, motions are what they say, the same seed is the same scene."""

import numpy as np
import pytest

from vision_robot.errors import BadRecipe
from vision_robot.geometry import plane_from_pixels
from vision_robot_synth.recipe import read_recipe, recipe_names
from vision_robot_synth.scene.scene import scene_of
from vision_robot_synth.scene.traffic import CLEARANCE_M, Footprint

VIDEOS = [name for name in recipe_names() if read_recipe(name).video.kind == "video"]


def one(tmp_path, text: str, **options):
    (tmp_path / "mine.toml").write_text(text)
    return scene_of(read_recipe(str(tmp_path / "mine.toml")).at(0.5), options.pop("seed", 0))


@pytest.mark.parametrize("name", VIDEOS)
def test_every_recipe_makes_a_scene_at_every_severity(name):
    for severity in (0.0, 1.0):
        recipe = read_recipe(name).with_video(frames=30).at(severity)
        scene = scene_of(recipe, 3)
        assert scene.exposures % 2 == 1
        again = scene_of(recipe, 3)
        assert [item.path for item in scene.design.items] == [item.path for item in again.design.items]
        assert scene.view.camera == again.view.camera


def test_the_object_of_an_axis_goes_the_same_way_at_every_severity():
    paths = [scene_of(read_recipe("noise").at(s), 5).design.items[0].path for s in (0.0, 0.5, 1.0)]
    assert paths[0] == paths[1] == paths[2]
    assert scene_of(read_recipe("noise").at(0.5), 6).design.items[0].path != paths[0]


def test_things_of_one_height_keep_clear_of_each_other():
    scene = scene_of(read_recipe("many-objects").at(0.3), 2)
    prints = []
    for item in scene.design.items:
        width = item.size_m[0] if item.shape == "disc" else item.size_m[1]
        prints.append(Footprint(item.size_m[0], width, 0.0))
    for time in np.arange(0, 4, 0.1):
        dots = []
        for item, footprint in zip(scene.design.items, prints, strict=True):
            assert item.path is not None
            start, end = footprint.ends(item.path.at(float(time))[None])[0]
            dots.append(start + np.linspace(0, 1, 40)[:, None] * (end - start))
        for i in range(len(dots)):
            for j in range(i):
                apart = np.linalg.norm(dots[i][:, None] - dots[j][None], axis=2).min()
                assert apart > (prints[i].width_m + prints[j].width_m) / 2 + CLEARANCE_M / 2


def test_roaming_keeps_its_speed_and_stays_in_the_picture(tmp_path):
    scene = one(tmp_path, "frames=300\n[things.rod]\nmotion='roam'\nspeed_mm_s=80\nspin_deg_s=0\narea=0.5\n")
    (item,) = scene.design.items
    assert item.path is not None
    times = np.arange(0, 10, 0.05)
    places = np.array([item.path.at(float(time)) for time in times])
    speeds = np.linalg.norm(np.diff(places[:, :2], axis=0), axis=1) / 0.05
    assert np.median(speeds) == pytest.approx(0.08, rel=1e-6)
    assert speeds.max() < 0.0801
    assert np.ptp(places[:, 3]) == 0
    pixels = scene.view.camera.project(scene.view.cam_from_station.apply(places[:, :3]))
    assert (np.abs(pixels - [319.5, 239.5]) <= [161, 121]).all()


def test_a_thing_that_stops_stands_still_as_long_as_it_is_told(tmp_path):
    scene = one(tmp_path, "frames=600\n[things.rod]\nmotion='stop'\npause_s=2\nspeed_mm_s=200\n")
    path = scene.design.items[0].path
    assert path is not None
    still = np.array([np.linalg.norm(path.rate(float(time))[:2]) == 0 for time in np.arange(0, 20, 0.05)])
    changes = np.flatnonzero(np.diff(still.astype(int)))
    lengths = np.diff(changes)[~still[changes[:-1]]] * 0.05
    assert len(lengths) > 3
    assert np.allclose(lengths, 2.0, atol=0.11)


def test_a_belt_carries_along_the_picture_at_its_speed(tmp_path):
    scene = one(tmp_path, "[belt]\nspeed_mm_s=100\n[things.box]\nshape='box'\ncount=4\nmotion='belt'\n")
    for item in scene.design.items:
        assert item.path is not None
        assert item.path.rate(1.0).tolist() == [0, 0.1, 0, 0]
        u = scene.view.camera.project(
            scene.view.cam_from_station.apply(np.array([item.path.at(t)[:3] for t in (0, 1)]))
        )[:, 0]
        assert u[1] > u[0]


def test_the_camera_sees_as_much_of_the_table_as_it_says(tmp_path):
    scene = one(tmp_path, "[camera]\nheight_mm=800\ntilt_deg=0\nfield_mm=400\noff_centre=0\n")
    camera, pose = scene.view.camera, scene.view.cam_from_station
    ends = plane_from_pixels(camera, pose, np.array([[-0.5, 239.5], [639.5, 239.5]]))
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(0.4)
    assert -(pose.rotation.T @ pose.translation)[2] == pytest.approx(0.8)
    # The station's y goes to the right.
    assert ends[1, 1] > ends[0, 1]


def test_a_shaking_camera_shakes_as_much_as_it_says(tmp_path):
    scene = one(tmp_path, "frames=9000\n[camera]\nshake_mm=2\nshake_deg=0.5\n")
    still = scene.view.cam_from_station.inverse()
    moves = [scene.cam_from_station(frame) @ still for frame in range(0, 9000, 30)]
    turns = np.degrees([move.rotvec() for move in moves])
    assert np.allclose(turns.std(axis=0), 0.5, rtol=0.3)
    assert one(tmp_path, "").shake.place_m == 0


def test_a_recipe_that_cannot_be_made_names_itself(tmp_path):
    with pytest.raises(BadRecipe, match=r"recipe mine: .*pencil"):
        one(tmp_path, "[things.rod]\nshape='pencil'\nlength_mm=20\nwidth_mm=10\n")
    with pytest.raises(BadRecipe, match=r"recipe mine: camera.distortion"):
        one(tmp_path, "[camera]\nlens='brown5'\ndistortion=[0, 0, 0, 0]\n")
