"""COLMAP's cameras.txt: half a pixel, every shared model, and COLMAP itself where it is installed."""

import numpy as np
import pytest

from vision_robot.errors import BadCameraFile
from vision_robot.formats import read_camera, read_cameras, write_camera
from vision_robot.geometry import Camera

LIST = """# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
# Number of cameras: 3
1 SIMPLE_PINHOLE 3072 2304 2559.81 1536 1152
2 PINHOLE 3072 2304 2560.56 2560.57 1536.5 1152.25
3 SIMPLE_RADIAL 3072 2304 2559.69 1536 1152 -0.0218531
4 RADIAL 3072 2304 2559.69 1536 1152 -0.02 0.003
5 OPENCV 3072 2304 2560 2561 1536 1152 0.1 0.2 0.03 0.04
6 OPENCV_FISHEYE 3072 2304 2560 2561 1536 1152 0.1 0.2 0.03 0.04
7 FULL_OPENCV 3072 2304 2560 2561 1536 1152 0.1 0.2 0.03 0.04 0.5 0.6 0.7 0.8
8 FULL_OPENCV 3072 2304 2560 2561 1536 1152 0.1 0.2 0.03 0.04 0.5 0 0 0
"""


def test_every_model_in_our_pixels(write_text):
    size, centre = (3072, 2304), (1535.5, 1151.5)
    assert read_cameras(write_text("cameras.txt", LIST)) == {
        "1": Camera(*size, 2559.81, 2559.81, *centre),
        "2": Camera(*size, 2560.56, 2560.57, 1536, 1151.75),
        "3": Camera(*size, 2559.69, 2559.69, *centre, 0, "brown5", (-0.0218531, 0, 0, 0, 0)),
        "4": Camera(*size, 2559.69, 2559.69, *centre, 0, "brown5", (-0.02, 0.003, 0, 0, 0)),
        "5": Camera(*size, 2560, 2561, *centre, 0, "brown5", (0.1, 0.2, 0.03, 0.04, 0)),
        "6": Camera(*size, 2560, 2561, *centre, 0, "fisheye", (0.1, 0.2, 0.03, 0.04)),
        "7": Camera(*size, 2560, 2561, *centre, 0, "brown8", (0.1, 0.2, 0.03, 0.04, 0.5, 0.6, 0.7, 0.8)),
        "8": Camera(*size, 2560, 2561, *centre, 0, "brown5", (0.1, 0.2, 0.03, 0.04, 0.5)),
    }


@pytest.mark.parametrize(
    ("model", "k", "name"),
    [
        ("pinhole", (), "PINHOLE"),
        ("brown5", (-0.2, 0.1, 1e-3, -2e-3, 0), "OPENCV"),
        ("brown5", (-0.2, 0.1, 1e-3, -2e-3, 0.05), "FULL_OPENCV"),
        ("brown8", (-0.2, 0.1, 1e-3, -2e-3, 0.05, 0.1, 0.02, 0.003), "FULL_OPENCV"),
        ("fisheye", (0.01, -0.02, 0.003, -0.0004), "OPENCV_FISHEYE"),
    ],
)
def test_colmap_projects_half_a_pixel_away(tmp_path, model, k, name):
    camera = Camera(640, 480, 500.25, 501, 1 / 3 + 320, 240.1, 0, model, k)
    write_camera(camera, tmp_path / "cameras.txt")
    words = (tmp_path / "cameras.txt").read_text().split("\n")[3].split()
    assert words[:4] == ["1", name, "640", "480"]

    pycolmap = pytest.importorskip("pycolmap")
    theirs = pycolmap.Camera(model=name, width=640, height=480, params=[float(word) for word in words[4:]])
    points = np.random.default_rng(0).uniform([-0.5, -0.4, 1], [0.5, 0.4, 2], (50, 3))
    assert theirs.img_from_cam(points) - 0.5 == pytest.approx(camera.project(points), abs=1e-9)


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("1 FOV 640 480 500 500 320 240 0.1", "line 2: model FOV is not supported: one of SIMPLE_PINHOLE"),
        ("1 PINHOLE 640 480 500 500 320", "line 2: PINHOLE: 4 numbers expected, 3 found"),
        ("1 PINHOLE 640 480 500 nan 320 240", r"line 2: PINHOLE\[1\]: a finite number expected, 'nan' found"),
        ("1 PINHOLE 640.5 480 500 500 320 240", "line 2: WIDTH: a whole number expected"),
        ("1 PINHOLE 640", "line 2: CAMERA_ID MODEL WIDTH HEIGHT"),
        ("# nothing", "no line CAMERA_ID MODEL"),
        ("1 PINHOLE 9 9 5 5 3 2\n1 PINHOLE 9 9 5 5 3 2", "line 3: camera 1 is there twice"),
    ],
)
def test_faults_are_named(write_text, line, why):
    with pytest.raises(BadCameraFile, match=why):
        read_camera(write_text("cameras.txt", f"# Camera list with one line of data per camera:\n{line}\n"))
