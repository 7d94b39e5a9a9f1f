"""`vr demo`: the main job ends with pictures, a camera and a page; a second run finds them again."""

import json

from vision_robot.formats import read_camera
from vision_robot_cli.main import run


def test_the_demo_leaves_a_camera_and_a_page_and_renders_only_once(capsys, tmp_path):
    out = tmp_path / "the demo"
    words = ["demo", "-o", str(out), "--views", "10", "--json"]
    assert run(words) == 0
    first = json.loads(capsys.readouterr().out)
    camera = read_camera(out / "camera.yaml")
    assert abs(camera.fx / first["calibration"]["truth"]["camera"]["fx"] - 1) < 3e-4
    assert "Against the truth" in (out / "report.html").read_text()
    frames = {path: path.stat().st_mtime_ns for path in (out / "boards").rglob("*.png")}
    assert len(frames) == 10
    assert run(words) == 0
    second = json.loads(capsys.readouterr().out)
    assert {path: path.stat().st_mtime_ns for path in (out / "boards").rglob("*.png")} == frames
    assert second["calibration"]["camera"] == first["calibration"]["camera"]


def test_a_folder_that_holds_something_else_is_left_alone(capsys, tmp_path):
    (tmp_path / "boards").mkdir()
    (tmp_path / "boards" / "mine.txt").write_text("keep")
    assert run(["demo", "-o", str(tmp_path)]) == 2
    assert "holds something else" in capsys.readouterr().err
    assert (tmp_path / "boards" / "mine.txt").read_text() == "keep"
