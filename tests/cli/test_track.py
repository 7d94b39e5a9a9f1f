"""`vr track` as a person runs it: files, options that belong to one tracker, and every bad input."""

import json

import cv2
import numpy as np
import pytest

from tests.track.scenes import SIZE, moving, rendered
from vision_robot.formats.work_plane import write_work_plane
from vision_robot.geometry import SE3, Camera
from vision_robot.geometry.work_plane import WorkPlane
from vision_robot.images import read_image
from vision_robot.tracks import COLUMNS, Tracks
from vision_robot.video import Video, VideoWriter
from vision_robot_cli.main import run

CAMERA = Camera(*SIZE, 300, 300, 120, 90)


@pytest.fixture(scope="module")
def clip(tmp_path_factory):
    path = tmp_path_factory.mktemp("clips") / "moving.mkv"
    with VideoWriter(path, SIZE, 25) as writer:
        for frame in rendered(moving, 40):
            writer.write(frame)
    return path


def refused(capsys, *words) -> str:
    assert run(["track", *map(str, words)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.strip().splitlines()
    return line


def test_everything_at_once(capsys, clip, tmp_path):
    plane = tmp_path / "plane.json"
    pose = SE3.from_rotvec(np.array([3.0, 0.1, 0]), np.array([0, 0, 0.5]))
    write_work_plane(WorkPlane.exact(CAMERA, pose), plane)
    out, overlay, report = (tmp_path / name for name in ("t.csv", "t.avi", "t.html"))
    words = ["--color", "red", "--color", "green", "--plane", plane, "--report", report, "--overlay", overlay]
    assert (
        run(["track", "video", str(clip), "--tracker", "rgb", *map(str, words), "-o", str(out), "--json"])
        == 0
    )
    found = json.loads(capsys.readouterr().out)
    assert found["schema"] == "vr.track/1"
    assert (found["frames"], found["objects"], found["out"]) == (40, 2, str(out))
    assert 0 < found["ms_per_frame"]["p50"] <= found["ms_per_frame"]["p99"]
    tracks = Tracks.read(out)
    assert out.read_text().splitlines()[0].startswith(",".join(COLUMNS))
    assert len(tracks) == 80
    assert np.isfinite(tracks.position_m).all()
    assert (tracks.extra["sigma_x_mm"] > 0).all()
    assert sum(1 for _ in Video(overlay)) == 40
    page = report.read_text()
    assert "On the work plane" in page or "Paths on the work plane" in page
    assert "speed [mm/s]" in page


def test_the_result_for_a_person_and_options_from_a_file(capsys, clip, tmp_path):
    config = tmp_path / "trackers.toml"
    config.write_text("[background]\nwindow = 21\n[rgb]\ntolerance = 20.0\n")
    assert run(["track", "video", str(clip), "--config", str(config), "--set", "background.hold_s=5"]) == 0
    out = capsys.readouterr().out
    assert "40 frames, 2 objects" in out
    assert "noise" in out
    words = ["track", "video", str(clip), "--config", str(config), "--options"]
    assert run(words) == 0
    assert "background.window = 21" in capsys.readouterr().out


def test_pick_shows_the_mask_and_suggests(capsys, clip, tmp_path):
    still = tmp_path / "still.png"
    cv2.imwrite(str(still), rendered(moving, 1)[0])
    for source in (still, clip):
        words = ["track", "pick", str(source), "--pick", "30,45", "-o", str(tmp_path / "mask.png"), "--json"]
        assert run(words) == 0
        found = json.loads(capsys.readouterr().out)
        assert found["schema"] == "vr.track.pick/1"
        assert found["objects"] == 1
        assert found["blobs"][0]["u_px"] == pytest.approx(30, abs=0.2)
        assert {"red", "green"} <= {one["colour"] for one in found["suggestions"]}
        assert read_image(tmp_path / "mask.png").shape == (*SIZE[::-1], 3)
    assert run(["track", "pick", str(still)]) == 0
    assert "suggested: --color" in capsys.readouterr().out


def test_ctrl_c_keeps_the_rows_so_far(capsys, clip, tmp_path, monkeypatch):
    frames = Video.__iter__

    def interrupted(self):
        for frame in frames(self):
            if frame.index == 25:
                raise KeyboardInterrupt
            yield frame

    monkeypatch.setattr(Video, "__iter__", interrupted)
    out = tmp_path / "t.csv"
    assert run(["track", "video", str(clip), "--tracker", "rgb", "--color", "red", "-o", str(out)]) == 130
    assert "interrupted" in capsys.readouterr().out
    assert Tracks.read(out).frame.tolist() == list(range(25))


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--set", "foo=1"], "option of tracker background is 'foo': it must be one of window=31"),
        (["--set", "rgb.tolerance=1"], "an option of the tracker that runs, background: window"),
        (["--set", "background.window"], "background.option=value"),
        (["--set", "background.window=8"], "an odd number from 3 to 255"),
        (["--color", "red"], "background knows no colours"),
        (["--tracker", "rgb", "--color", "mauve"], "colour is 'mauve'"),
        (["--tracker", "rgb", "--pick", "999,1"], "inside the picture of 240x180 px"),
        (["--tracker", "kcf"], "one of optical-flow"),
        (["-o", "tracks.xlsx"], "named *.csv, *.json or *.txt"),
        (["--overlay", "a.gif"], "--overlay"),
        (["--config", "none.toml"], "--config"),
        (["--camera", "camera.json"], "given together with --plane"),
        (["--confirm", "0"], "confirm is 0"),
    ],
)
def test_bad_input_is_named(capsys, clip, words, says):
    assert says in refused(capsys, "video", clip, *words)


def test_bad_videos_are_named(capsys, tmp_path):
    assert "there is no such file" in refused(capsys, "video", tmp_path / "none.mp4")
    (tmp_path / "empty.mp4").write_bytes(b"")
    assert "no frame of it can be decoded" in refused(capsys, "video", tmp_path / "empty.mp4")
    assert "camera 99" in refused(capsys, "camera", 99)


def test_a_plane_of_another_camera_is_named(capsys, clip, tmp_path):
    pose = SE3.from_rotvec(np.array([3.0, 0.1, 0]), np.array([0, 0, 0.5]))
    write_work_plane(WorkPlane.exact(Camera(640, 480, 500, 500, 320, 240), pose), tmp_path / "plane.json")
    assert "640x480 px, the calibrated camera's" in refused(
        capsys, "video", clip, "--plane", tmp_path / "plane.json"
    )
    write_work_plane(
        WorkPlane.exact(CAMERA, SE3(np.eye(3), np.array([0, 0, -1.0]))), tmp_path / "behind.json"
    )
    assert "behind the camera" in refused(capsys, "video", clip, "--plane", tmp_path / "behind.json")
