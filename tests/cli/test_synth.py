"""`vr synth` as a person runs it."""

import json

import cv2
import pytest

from vision_robot.dataset import open_dataset
from vision_robot_cli.main import run


def test_list_and_keys(capsys):
    assert run(["synth", "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 17
    assert any(line.startswith("single-rod ") for line in lines)
    assert run(["synth", "--list", "--json"]) == 0
    assert {"name", "description", "severity_turns"} <= set(json.loads(capsys.readouterr().out)["recipes"][0])
    assert run(["synth", "--keys"]) == 0
    text = capsys.readouterr().out
    for key in ("things.NAME.colour", "sensor.read_noise", "camera.height_mm", "frames"):
        assert key in text


def test_a_dataset_with_its_films(capsys, tmp_path):
    words = ["synth", "single-rod", "-o", str(tmp_path / "rod"), "--frames", "5", "--size", "96x72"]
    words += ["--seed", "2", "--severity", "0.2", "--json"]
    assert run([*words, "--preview", "--mp4"]) == 0
    captured = capsys.readouterr()
    found = json.loads(captured.out)
    assert found["schema"] == "vr.synth/1"
    assert (found["recipe"], found["seed"], found["severity"], found["frames"]) == ("single-rod", 2, 0.2, 5)
    assert found["rendered"] == 5
    assert found["objects"][0]["name"] == "rod"
    data = open_dataset(found["out"])
    assert len(data) == 5
    sheet = cv2.imread(str(tmp_path / "rod" / "preview.png"))
    assert sheet is not None
    assert sheet.shape[1] > sheet.shape[0] * 0.8
    film = cv2.VideoCapture(str(tmp_path / "rod" / "video.mp4"))
    assert film.get(cv2.CAP_PROP_FRAME_COUNT) == 5
    assert (tmp_path / "rod" / "preview.webm").stat().st_size > 100
    assert run(words) == 0
    assert json.loads(capsys.readouterr().out)["rendered"] == 0


def test_views_of_a_board(capsys, tmp_path):
    words = ["synth", "calibration", "-o", str(tmp_path / "b"), "--frames", "3", "--size", "320x240"]
    assert run(words) == 0
    assert "3 frames of 320 x 240 px" in capsys.readouterr().out
    data = open_dataset(tmp_path / "b")
    assert data.camera is not None
    assert (len(data), data.size, data.camera.width) == (3, (320, 240), 320)


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ([], "vr synth --list"),
        (["singel-rod"], "do you mean single-rod?"),
        (["none.toml"], "no such file"),
        (["single-rod", "--frames", "0"], "--frames is 0"),
        (["single-rod", "--size", "big"], "--size"),
        (["single-rod", "--severity", "2"], "severity is 2.0"),
        (["single-rod", "--workers", "0"], "workers is 0"),
        (["single-rod", "--seed", "-1"], "seed is -1"),
        (["single-rod", "-o", "taken"], "something else"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(capsys, tmp_path, monkeypatch, words, why):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "file").write_text("")
    assert run(["synth", *words]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.strip().splitlines()
    assert why in line
    assert {p.name for p in tmp_path.iterdir()} == {"taken"}
