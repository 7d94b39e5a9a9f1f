"""`vr pick` as a person runs it."""

import json

import pytest

from vision_robot_cli.main import run


def test_two_episodes_with_their_numbers(capsys):
    assert run(["pick", "--episodes", "2", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["schema"] == "vr.pick/1"
    assert found["episodes"] == 2
    assert found["grasp_success"] == found["place_success"] == 1
    assert found["position_error_mm"]["median"] < 2
    assert found["error_budget"] is None
    assert [one["rung"] for one in found["each"]] == ["placed", "placed"]


def test_a_missed_success_ends_with_3(capsys):
    assert run(["pick", "--episodes", "1", "--set", "color=green", "--min-success", "0.9"]) == 3
    captured = capsys.readouterr()
    assert "does not see rod" in captured.out
    assert "grasp_success" in captured.err


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--episodes", "0"], "--episodes"),
        (["--loop", "blind"], "look-move-look"),
        (["--tracker", "yolo"], "background"),
        (["--set", "red"], "color=red"),
        (["--set", "colour=red"], "color="),
        (["--fault", "rain=1"], "camera-rotation"),
        (["--fault", "camera-rotation=1"], "deg"),
        (["--fault", "lens=plastic"], "brown5"),
        (["--workers", "0"], "--workers"),
    ],
)
def test_bad_input_is_one_line(capsys, arguments, says):
    assert run(["pick", *arguments]) == 2
    captured = capsys.readouterr()
    assert says in captured.err
    assert len(captured.err.strip().splitlines()) == 1
