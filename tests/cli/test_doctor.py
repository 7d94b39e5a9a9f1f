"""Proves that `vr doctor` reports every part, names cures, and says in its exit code that one is needed."""

import json

import pytest

from vision_robot import machine
from vision_robot.machine import Check, Status
from vision_robot_cli.main import run

GOOD = Check("opengl", "render", Status.OK, "EGL, 9 ms a frame", details={"ms_per_frame": 9.0})
ABSENT = Check("compute", "C compiler", Status.ABSENT, "none", "apt-get install gcc")
BAD = Check("packages", "numpy", Status.BROKEN, "not installed", "uv pip install numpy")


@pytest.fixture
def found(monkeypatch):
    def set_checks(*checks):
        monkeypatch.setattr(machine, "examine", lambda full: list(checks))

    return set_checks


def test_all_is_well(found, capsys):
    found(GOOD, ABSENT)
    assert run(["doctor"]) == 0
    said = capsys.readouterr()
    assert "9 ms a frame" in said.out
    assert "apt-get install gcc" in said.out
    assert said.err == ""


def test_something_needed_is_broken(found, capsys):
    found(GOOD, BAD)
    assert run(["doctor"]) == 1
    said = capsys.readouterr()
    assert "uv pip install numpy" in said.out
    assert said.err == "vr: 1 needed thing(s) broken: numpy\n"


def test_json_says_the_same(found, capsys):
    found(GOOD, BAD)
    assert run(["doctor", "--json"]) == 1
    report = json.loads(capsys.readouterr().out)
    assert report["schema"] == "vr.doctor/1"
    assert report["ok"] is False
    assert report["checks"][0]["details"] == {"ms_per_frame": 9.0}
    assert report["checks"][1] == {
        "topic": "packages",
        "name": "numpy",
        "status": "broken",
        "found": "not installed",
        "mend": "uv pip install numpy",
        "details": {},
    }


def test_the_real_examination_covers_every_part(capsys):
    """On the machine that runs the tests, whatever it has."""
    code = run(["doctor", "--json"])
    report = json.loads(capsys.readouterr().out)
    assert code == (0 if report["ok"] else 1)
    names = {check["name"] for check in report["checks"]}
    assert {"python", "system", "mujoco", "torch", "render", "torch device", "C compiler", "cores"} <= names
    assert any(name.startswith("MJPG") for name in names)
    for check in report["checks"]:
        if check["status"] == "broken":
            assert check["mend"], check
        if check["name"] == "render" and check["status"] == "ok":
            assert check["details"]["right"] is True
            assert 0 < check["details"]["ms_per_frame"] < 5000
