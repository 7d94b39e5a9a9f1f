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


def test_a_page_a_film_and_a_budget(capsys, tmp_path):
    page, film = tmp_path / "pick.html", tmp_path / "pick.mp4"
    words = ["--episodes", "1", "--budget", "--report", str(page), "--video", str(film), "--fps", "2"]
    assert run(["pick", *words, "--json"]) == 0
    budget = json.loads(capsys.readouterr().out)["error_budget"]
    stages = ("calibration", "tracking", "plane", "ik", "control")
    assert sum(budget[one] for one in stages) + budget["unexplained"] == pytest.approx(budget["total"])
    assert sum(budget["predicted"][one] for one in stages) == pytest.approx(budget["predicted"]["total"])
    assert budget["alone"]["ik"]["verdict"] == "agrees"
    assert "Where the millimetres come from" in page.read_text()
    assert film.stat().st_size > 10_000


def test_a_film_that_cannot_be_written_is_refused_before_any_episode(capsys):
    assert run(["pick", "--episodes", "100000", "--video", "pick.gif"]) == 2
    assert ".mp4" in capsys.readouterr().err
    assert run(["pick", "--episodes", "100000", "--video", "pick.mp4", "--fps", "0"]) == 2
    assert "--fps" in capsys.readouterr().err


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
        (["--fault", "latency=-1ms"], "from 0"),
        (["--fault", "lost-sight=200%"], "to 1"),
        (["--scene", "moon"], "conveyor"),
        (["--object", "banana"], "pencil"),
        (["--object", "rod:120x10"], "length x diameter"),
        (["--object", "rod:120x10x5mm"], "length x diameter"),
        (["--belt-speed", "60mm/s"], "no belt"),
        (["--belt-speed", "60mm", "--scene", "conveyor"], "60mm/s"),
        (["--tries", "0"], "tries"),
        (["--recipe", "moon"], "vr synth --list"),
        (["--recipe", "single-rod", "--object", "rod"], "--recipe"),
        (["--arm", "nosuch.xml"], "no such file"),
        (["--arm", "arm.urdf"], "MJCF"),
    ],
)
def test_bad_input_is_one_line(capsys, arguments, says):
    assert run(["pick", *arguments]) == 2
    captured = capsys.readouterr()
    assert says in captured.err
    assert len(captured.err.strip().splitlines()) == 1


def test_things_are_named_with_size_and_colour():
    from vision_robot_cli.pick_cell import colour_names, item_of

    box, disc = item_of("box:40x25x15mm:green", 0), item_of("disc", 1)
    assert (box.shape, box.size_m, box.name) == ("box", (0.04, 0.025, 0.015), "box")
    assert disc.name == "disc 2"
    assert colour_names([box, disc, box]) == ("green",)


def test_what_is_too_wide_is_counted_with_its_reason(capsys):
    assert run(["pick", "--episodes", "1", "--object", "box:90x80x20mm", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["endings"] == {"gripper too narrow": 1}
    assert found["intervals"]["seen"][1] == 1
    assert found["grasp_success"] == 0
    assert "80 mm" in found["each"][0]["failure"]
