"""`vr demo`: the main job ends with a page, a film and a camera."""

import json

import pytest

from vision_robot.formats import read_camera
from vision_robot.video import Video
from vision_robot_cli.main import run


def test_the_demo_tells_the_whole_story(capsys, tmp_path):
    out = tmp_path / "the demo"
    words = ["demo", "-o", str(out), "--views", "8", "--frames", "12", "--episodes", "1", "--workers", "1"]
    assert run([*words, "--json"]) == 0
    captured = capsys.readouterr()
    found = json.loads(captured.out)
    assert "report.html" in captured.err
    camera = read_camera(out / "camera.yaml")
    assert abs(camera.fx / found["calibration"]["truth"]["camera"]["fx"] - 1) < 1e-3
    assert found["plane"]["error_mm"] < 1
    assert set(found["tracking"]) == {"rgb", "background", "optical-flow"}
    assert found["tracking"]["rgb"]["recall"] > 0.9
    assert all(one["ik_success"] == 1 for one in found["ik"])
    picks = found["pick"]
    assert picks["open loop"]["grasp_success"] == 1
    assert picks["camera knocked by 1°, open loop"]["grasp_success"] == 0
    assert found["seconds"]["total"] > 0
    html = (out / "report.html").read_text()
    for chapter in ("1. The camera", "2. The table", "3. Three trackers", "4. The arm", "5. The pick"):
        assert chapter in html
    assert "Against the truth" in (out / "calibration.html").read_text()
    assert len(list(Video(out / "pick.mp4"))) > 30


def test_a_folder_that_holds_something_else_is_left_alone(capsys, tmp_path):
    (tmp_path / "boards").mkdir()
    (tmp_path / "boards" / "mine.txt").write_text("keep")
    assert run(["demo", "-o", str(tmp_path)]) == 2
    assert "holds something else" in capsys.readouterr().err
    assert (tmp_path / "boards" / "mine.txt").read_text() == "keep"


@pytest.mark.parametrize(
    "words", [["--episodes", "0"], ["--frames", "3"], ["--views", "0"], ["--workers", "0"]]
)
def test_bad_input_is_one_line(capsys, tmp_path, words):
    assert run(["demo", "-o", str(tmp_path / "demo"), *words]) == 2
    error = capsys.readouterr().err.strip()
    assert words[0] in error
    assert len(error.splitlines()) == 1
