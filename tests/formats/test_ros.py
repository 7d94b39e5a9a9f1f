"""ROS camera_info: the three models, its matrices, and the text of a message."""

import pytest
import yaml

from vision_robot.errors import BadCameraFile
from vision_robot.formats import read_camera, write_camera
from vision_robot.geometry import Camera

# As camera_calibration writes it.
PUBLISHED = """image_width: 640
image_height: 488
camera_name: prosilica
camera_matrix:
  rows: 3
  cols: 3
  data: [1128.77, 0, 393.79, 0, 1129.22, 305.42, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.207, 0.0798, 0.00173, -0.00046, 0]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [1100.1, 0, 393.1, 0, 0, 1110.2, 305.2, 0, 0, 0, 1, 0]
"""

PROSILICA = Camera(
    640, 488, 1128.77, 1129.22, 393.79, 305.42, 0, "brown5", (-0.207, 0.0798, 0.00173, -0.00046, 0)
)

MESSAGE = """header:
  stamp: {sec: 1, nanosec: 0}
height: 488
width: 640
distortion_model: equidistant
d: [0.1, 0.2, 0.3, 0.4]
k: [400.0, 0.0, 320.0, 0.0, 401.0, 240.0, 0.0, 0.0, 1.0]
r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
p: [400.0, 0.0, 320.0, 0.0, 0.0, 401.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 0
---
"""


def test_published(write_text):
    assert read_camera(write_text("ost.yaml", PUBLISHED)) == PROSILICA


def test_message_text(write_text):
    expected = Camera(640, 488, 400, 401, 320, 240, 0, "fisheye", (0.1, 0.2, 0.3, 0.4))
    assert read_camera(write_text("message.yaml", MESSAGE)) == expected


def test_missing_model_is_plumb_bob_as_ros_takes_it(write_text):
    text = PUBLISHED.replace("distortion_model: plumb_bob\n", "")
    assert read_camera(write_text("ost.yaml", text)) == PROSILICA


@pytest.mark.parametrize(
    ("model", "k", "name"),
    [
        ("pinhole", (), "plumb_bob"),
        ("brown5", (1e-5, 0.2, 1e22, 0, 0.3), "plumb_bob"),
        ("brown8", (0.1,) * 8, "rational_polynomial"),
        ("fisheye", (0.1,) * 4, "equidistant"),
    ],
)
def test_written_as_an_ordinary_yaml_reader_sees_it(tmp_path, model, k, name):
    camera = Camera(640, 480, 500, 501, 320.25, 240.5, 0, model, k)
    write_camera(camera, tmp_path / "a.yaml", "ros")
    tree = yaml.safe_load((tmp_path / "a.yaml").read_text())
    assert tree["distortion_model"] == name
    assert tree["distortion_coefficients"]["data"] == list(k or (0.0,) * 5)
    assert tree["camera_matrix"]["data"] == camera.K.ravel().tolist()
    assert tree["rectification_matrix"]["data"] == [1, 0, 0, 0, 1, 0, 0, 0, 1]
    assert tree["projection_matrix"]["data"] == [500, 0, 320.25, 0, 0, 501, 240.5, 0, 0, 0, 1, 0]
    for matrix in ("camera_matrix", "distortion_coefficients", "rectification_matrix", "projection_matrix"):
        assert len(tree[matrix]["data"]) == tree[matrix]["rows"] * tree[matrix]["cols"]


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        (
            "plumb_bob",
            "thin_prism",
            "distortion_model is 'thin_prism': one of plumb_bob, rational_polynomial",
        ),
        ("plumb_bob", "equidistant", "distortion_coefficients.data: 4 numbers expected, 5 found"),
        ("plumb_bob", "[a]", "distortion_model: a word expected"),
        ("image_height: 488", "", "image_height is missing"),
        ("image_width: 640", "binning_x: 2\nimage_width: 640", "binned pictures are not supported"),
        ("camera_matrix:\n", "camera_matrix: 5\nother:\n", "camera_matrix: a list of numbers expected"),
    ],
)
def test_faults_are_named(write_text, old, new, why):
    with pytest.raises(BadCameraFile, match=why):
        read_camera(write_text("a.yaml", PUBLISHED.replace(old, new)))
