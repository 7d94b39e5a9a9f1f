"""Proves what a recording for rerun holds where rerun-sdk is installed, and what is said where it is not."""

import sys

import numpy as np
import pytest

from tests.track.scenes import SIZE, moving, rendered
from vision_robot.formats.work_plane import write_work_plane
from vision_robot.geometry import SE3, Camera
from vision_robot.geometry.work_plane import WorkPlane
from vision_robot.video import VideoWriter
from vision_robot_cli.main import run
from vision_robot_cli.track_rerun import _axes

FRAMES = 12


@pytest.fixture
def words(tmp_path):
    """A run of the tracker rgb on a short clip, with a plane."""
    with VideoWriter(tmp_path / "moving.mkv", SIZE, 25) as writer:
        for frame in rendered(moving, FRAMES):
            writer.write(frame)
    pose = SE3.from_rotvec(np.array([3.0, 0.1, 0]), np.array([0, 0, 0.5]))
    write_work_plane(WorkPlane.exact(Camera(*SIZE, 300, 300, 120, 90), pose), tmp_path / "plane.json")
    files = ["--plane", str(tmp_path / "plane.json"), "-o", str(tmp_path / "t.csv")]
    return ["track", "video", str(tmp_path / "moving.mkv"), "--tracker", "rgb", "--color", "red", *files]


def test_a_recording_holds_pictures_boxes_and_speeds_in_time(words, tmp_path):
    pytest.importorskip("rerun", reason="rerun-sdk is an extra of 650 MB")
    from rerun.chunk import RrdReader  # pyright: ignore[reportMissingImports]

    path = tmp_path / "run.rrd"
    assert run([*words, "--rerun", str(path)]) == 0
    rows: dict[str, int] = {}
    for chunk in RrdReader(str(path)).stream():
        rows[chunk.entity_path] = rows.get(chunk.entity_path, 0) + chunk.num_rows
    each_frame = ("/frame", "/frame/mask", "/frame/boxes", "/frame/axes", "/plane_mm")
    # A row more of /frame: what the mask's number means. An object is confirmed at its third sighting.
    assert {name: rows[name] for name in each_frame} == dict.fromkeys(each_frame, FRAMES) | {
        "/frame": FRAMES + 1
    }
    for quantity in ("speed_px_s", "speed_mm_s", "yaw_deg"):
        assert rows[f"/{quantity}/1"] == FRAMES - 2


def test_without_rerun_it_says_what_to_install_before_any_work(words, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    assert run([*words, "--rerun", str(tmp_path / "run.rrd")]) == 1
    said = capsys.readouterr().err
    assert said == (
        "vr: error: a recording for the viewer rerun needs the package rerun-sdk: "
        "install it with 'pip install rerun-sdk'\n"
    )
    assert not (tmp_path / "t.csv").exists()


def test_axes_go_through_the_centre_along_the_yaw():
    (line,) = _axes(np.array([[10.0, 20]]), np.array([[8.0, 2]]), np.array([np.pi / 2]))
    np.testing.assert_allclose(line, [[10, 16], [10, 24]], atol=1e-12)
