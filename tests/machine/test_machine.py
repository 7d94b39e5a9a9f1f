"""Proves that each check tells working from broken: a crash, a wrong picture, an old version, no codec."""

import importlib.metadata
import os

import pytest

from vision_robot.machine import compute, packages, rendering, videos
from vision_robot.machine.apart import Crashed, apart
from vision_robot.machine.check import Status

ANSWER = {"back_end": "EGL", "renderer": "soft", "failed": {}, "ms_per_frame": 9.0, "right": True}


def answer() -> int:
    return 42


def crash() -> int:
    os._exit(11)


def test_a_trial_apart_answers_or_is_said_to_have_crashed():
    assert apart(answer) == 42
    with pytest.raises(Crashed):
        apart(crash)


def test_a_crashing_driver_is_a_finding(monkeypatch):
    monkeypatch.setattr(rendering, "trial_render", crash)
    found = rendering.check()
    assert found.status is Status.BROKEN
    assert "crashed" in found.found
    assert found.mend


@pytest.mark.parametrize(
    ("change", "status", "words"),
    [
        ({}, Status.OK, "EGL, soft, 9 ms a frame"),
        ({"right": False}, Status.BROKEN, "wrong picture"),
        ({"failed": {"EGL": "no libEGL"}}, Status.OK, "EGL: no libEGL"),
    ],
)
def test_the_render(monkeypatch, change, status, words):
    monkeypatch.setattr(rendering, "apart", lambda trial: {**ANSWER, **change})
    found = rendering.check()
    assert found.status is status
    assert words in found.found


def test_no_opengl_at_all(monkeypatch):
    monkeypatch.setattr(rendering, "apart", lambda trial: {"failed": {"EGL": "no libEGL"}})
    found = rendering.check()
    assert (found.status, bool(found.mend)) == (Status.BROKEN, True)
    assert "EGL: no libEGL" in found.found


def test_every_dependency_is_looked_at():
    names = {check.name for check in packages.dependencies()}
    assert {
        "casadi",
        "kornia",
        "mujoco",
        "numpy",
        "opencv-contrib-python-headless",
        "torch",
        "typer",
    } <= names


def test_a_missing_and_an_old_package_are_broken_and_get_a_cure(monkeypatch):
    monkeypatch.setattr(importlib.metadata, "requires", lambda name: ["numpy>=999", "not-there>=1", "typer"])
    old, missing, fine = packages.dependencies()
    assert old.status is missing.status is Status.BROKEN
    assert ">=999" in old.found
    assert old.mend.endswith("'numpy>=999'")
    assert missing.found == "not installed"
    assert fine.status is Status.OK


def test_codecs(monkeypatch):
    monkeypatch.setattr(videos, "apart", lambda trial: {"MJPG": True, "FFV1": False})
    status = {check.name: check.status for check in videos.checks()}
    assert status["MJPG in .avi"] is Status.OK
    assert status["FFV1 in .mkv"] is Status.BROKEN
    assert status["avc1 in .mp4"] is Status.ABSENT


def test_a_film_comes_back_frame_for_frame():
    assert videos.trial_films()["MJPG"]


def test_compute(monkeypatch):
    assert compute.cores().details["cores"] >= 1
    monkeypatch.setattr(compute.shutil, "which", lambda name: None)
    assert compute.compiler().status is Status.ABSENT
    assert compute.compiler().mend
    assert compute.torch_device().details["device"] in ("cpu", "cuda")
