"""Proves that `vr calibrate` and `vr track video` take ROS bags as they take videos."""

import json

import pytest

from tests.bag.bags import packed, raw, write_bag
from tests.track.scenes import moving, rendered
from vision_robot.calibrate.boards import board_named
from vision_robot.geometry import Camera
from vision_robot.tracks import Tracks
from vision_robot_cli.main import run
from vision_robot_synth.calibration import calibration_set

SIZE = (6, 5)


@pytest.fixture(scope="module")
def board_bag(tmp_path_factory):
    camera = Camera(480, 360, 500, 502, 238, 181)
    truth = calibration_set(camera, board_named("chessboard", SIZE, 0.03), views=6, seed=1)
    left = [raw(picture, "mono8") for picture in truth.images()]
    right = [packed(one) for one in rendered(moving, 2)]
    topics = {"/left/image_raw": left, "/right/compressed": right}
    return write_bag(tmp_path_factory.mktemp("bag"), "mcap", topics), truth.camera


def test_a_camera_from_a_bag(capsys, board_bag):
    bag, true = board_bag
    words = ["calibrate", str(bag), "--size", "6x5", "--square", "30mm", "--model", "pinhole", "--json"]
    assert run(words) == 2
    said = capsys.readouterr().err
    assert "choose with --topic among /left/image_raw (6), /right/compressed (2)" in said
    assert run([*words, "--topic", "/left/image_raw"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["views_used"] == 6
    assert found["camera"]["fx"] == pytest.approx(true.fx, rel=0.01)


def test_tracks_from_a_bag(capsys, tmp_path):
    bag = write_bag(tmp_path, "ros1", {"/camera": [packed(one) for one in rendered(moving, 30)]})
    out = tmp_path / "t.csv"
    words = ["track", "video", str(bag), "--tracker", "rgb", "--color", "red", "-o", str(out), "--json"]
    assert run(words) == 0
    assert json.loads(capsys.readouterr().out)["objects"] == 1
    tracks = Tracks.read(out)
    assert len(tracks) == 30
    assert tracks.time_s[-1] == pytest.approx(29 * 0.04)
    assert run([*words, "--topic", "/none"]) == 2
    assert "no pictures on topic /none, but on /camera (30)" in capsys.readouterr().err
