"""Our own JSON, and the output of `vr calibrate --json` taken as a camera file."""

import json

import pytest

from vision_robot.errors import BadCameraFile
from vision_robot.formats import read_camera, write_camera
from vision_robot.geometry import Camera

CAMERA = Camera(640, 480, 500, 501, 320, 240, 0.25, "brown5", (1e-5, 0.2, 0.3, 0.4, 0.5))
OBJECT = {
    "width": 640,
    "height": 480,
    "fx": 500,
    "fy": 501,
    "cx": 320,
    "cy": 240,
    "skew": 0.25,
    "model": "brown5",
    "distortion": [1e-5, 0.2, 0.3, 0.4, 0.5],
}


def test_output_of_calibrate_reads(write_text):
    output = {"schema": "vr.calibrate/1", "rms_px": 0.2, "truth": None, "ok": True, "camera": OBJECT}
    assert read_camera(write_text("a.json", json.dumps(output))) == CAMERA
    assert read_camera(write_text("a.json", json.dumps(OBJECT))) == CAMERA


def test_written_object_has_the_keys_of_the_contract(tmp_path):
    write_camera(CAMERA, tmp_path / "a.json")
    assert json.loads((tmp_path / "a.json").read_text()) == {"schema": "vr.camera/1", "camera": OBJECT}


@pytest.mark.parametrize(
    ("key", "value", "why"),
    [
        ("fx", "wide", "camera.fx: a finite number expected, 'wide' found"),
        ("fx", None, "camera.fx: a finite number expected, None found"),
        ("fx", float("nan"), "camera.fx: a finite number expected, 'NaN' found"),
        ("model", "brown6", "camera.model: camera model is 'brown6': it must be one of pinhole, brown5"),
        ("model", "fisheye", "camera.distortion: 4 numbers expected, 5 found"),
        ("distortion", {}, "camera.distortion: a list of numbers expected"),
        ("width", 640.5, "camera.width: a whole number expected, 640.5 found"),
        ("height", 0, "image size is 640x0: 1 to 100000 px expected"),
    ],
)
def test_faults_are_named(write_text, key, value, why):
    with pytest.raises(BadCameraFile, match=why):
        read_camera(write_text("a.json", json.dumps({"camera": {**OBJECT, key: value}})))


def test_a_missing_key_and_a_broken_line_are_named(write_text):
    text = json.dumps({"camera": {key: value for key, value in OBJECT.items() if key != "cx"}})
    with pytest.raises(BadCameraFile, match="camera: cx is missing"):
        read_camera(write_text("a.json", text))
    with pytest.raises(BadCameraFile, match="line 4: Expecting"):
        read_camera(write_text("a.json", '{\n"fx": 1,\n"fy": 2\n"cx": 3}'))
