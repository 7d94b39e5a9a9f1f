"""OpenCV's FileStorage against OpenCV itself and against a published file."""

from importlib.resources import files
from pathlib import Path

import cv2
import numpy as np
import pytest

from vision_robot.errors import BadCameraFile
from vision_robot.formats import read_camera, read_cameras, write_camera
from vision_robot.geometry import Camera

CAMERAS = [
    Camera(640, 480, 1 / 3 + 500, 501, 319.5, 1e-7, 0, "brown5", (-0.3, 1e-5, 1e-22, -2e-4, 0.1)),
    Camera(640, 480, 500, 501, 319.5, 239.5, 0, "brown8", (-0.3, 0.1, 1e-3, -2e-4, 0.1, 0.2, 0.03, 1e-3)),
    Camera(640, 480, 500, 501, 319.5, 239.5, 0, "fisheye", (0.01, -0.02, 0.003, -0.0004)),
    Camera(640, 480, 500, 501, 319.5, 239.5),
]


def numbers(camera: Camera) -> np.ndarray:
    return np.array(camera.distortion or (0.0,) * 5)


@pytest.mark.parametrize("camera", CAMERAS, ids=lambda camera: camera.model)
@pytest.mark.parametrize("suffix", [".yml", ".json", ".xml"])
class TestAgainstOpenCV:
    def test_opencv_reads_what_we_write(self, tmp_path, camera, suffix):
        path = tmp_path / f"camera{suffix}"
        write_camera(camera, path, "opencv")
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
        assert np.array_equal(storage.getNode("camera_matrix").mat(), camera.K)
        assert np.array_equal(storage.getNode("distortion_coefficients").mat().ravel(), numbers(camera))
        assert storage.getNode("image_width").real() == 640
        assert storage.getNode("fisheye_model").real() == (camera.model == "fisheye")

    def test_we_read_what_opencv_writes(self, tmp_path, camera, suffix):
        path = tmp_path / f"camera{suffix}"
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
        storage.write("calibration_time", "Thu 01 Jan 2026 00:00:00")
        storage.write("image_width", 640)
        storage.write("image_height", 480)
        if camera.model == "fisheye":
            storage.write("fisheye_model", 1)
        storage.write("camera_matrix", camera.K)
        storage.write("distortion_coefficients", numbers(camera).reshape(-1, 1))
        storage.write("per_view_reprojection_errors", np.array([[0.1], [np.nan]], np.float32))
        storage.release()
        assert read_camera(path) == camera


def test_lens_means_what_opencv_means_by_it():
    points = np.random.default_rng(0).uniform([-0.5, -0.4, 1], [0.5, 0.4, 2], (50, 3))
    for camera in CAMERAS:
        zero = np.zeros(3)
        project = cv2.fisheye.projectPoints if camera.model == "fisheye" else cv2.projectPoints
        args = (points.reshape(-1, 1, 3), zero, zero, camera.K, numbers(camera))
        assert camera.project(points) == pytest.approx(project(*args)[0].reshape(-1, 2), abs=1e-9)


def test_published_file():
    path = Path(str(files("mvtbdata") / "data" / "left_intrinsics.yml"))
    camera = read_camera(path)
    assert camera == Camera(
        640,
        480,
        5.3591573396163199e02,
        5.3591573396163199e02,
        3.4228315473308373e02,
        2.3557082909788173e02,
        0.0,
        "brown5",
        (
            -2.6637260909660682e-01,
            -3.8588898922304653e-02,
            1.7831947042852964e-03,
            -2.8122100441115472e-04,
            2.3839153080878486e-01,
        ),
    )


OLD = """%YAML:1.0
calibration_Time: "Fri 01"
image_Width: 1280
image_Height: 720
Camera_Matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 900., 0.5, 640., 0., 901., 360., 0., 0., 1. ]
Distortion_Coefficients: !!opencv-matrix
   rows: 4
   cols: 1
   dt: d
   data: [ .1, -2e-1, 3.e-3, 4.E-04 ]
"""


class TestOtherSpellings:
    def test_old_sample_four_coefficients_and_skew(self, write_text):
        expected = Camera(1280, 720, 900, 901, 640, 360, 0.5, "brown5", (0.1, -0.2, 0.003, 0.0004, 0))
        assert read_camera(write_text("a.yml", OLD)) == expected

    def test_stereo_pair_without_size(self, write_text):
        head = "!!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
        matrix = head + "   data: [ {}, 0., 2., 0., 5., 3., 0., 0., 1. ]"
        zeros = "!!opencv-matrix\n   rows: 1\n   cols: 14\n   dt: d\n   data: [ 0.1" + ", 0." * 13 + " ]"
        text = f"%YAML 1.2\n---\nM1: {matrix.format(4)}\nD1: {zeros}\nM2: {matrix.format(6)}\nD2: {zeros}\n"
        path = write_text("intrinsics.yml", text)
        cameras = read_cameras(path, size=(64, 48))
        assert [(name, camera.fx) for name, camera in cameras.items()] == [("1", 4), ("2", 6)]
        assert cameras["1"].model == "brown8"
        with pytest.raises(BadCameraFile, match=r"does not hold the image size: give size=\(width, height\)"):
            read_cameras(path)


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ("0., 0., 1. ]", "0., 1. ]", "Camera_Matrix.data: 9 numbers expected, 8 found"),
        ("0., 0., 1. ]", "0., 0., 2. ]", r"Camera_Matrix.data: \[fx s cx 0 fy cy 0 0 1\] expected"),
        ("   rows: 4", "   rows: 5", "Distortion_Coefficients.data: 5 numbers expected, 4 found"),
        ("-2e-1", ".Nan", r"Distortion_Coefficients.data\[1\]: a finite number expected, '.Nan' found"),
        ("image_Height: 720", "", "image_height is missing"),
        ("Distortion_Coefficients:", "Lens:", "distortion_coefficients is missing"),
        ("4.E-04 ]", "4.E-04", "line 15: did not find expected"),
        ("rows: 4", "rows: 14", "14 numbers expected, 4 found"),
        (".1, -2e-1, 3.e-3, 4.E-04", "[.1, -2e-1], [[3.e-3, 4.E-04, {a: 1}]]", "numbers expected, 5 found"),
        ("900.", "-900.", r"focal length is \(-900.0, 901.0\): it must be positive"),
    ],
)
def test_faults_are_named(write_text, old, new, why):
    with pytest.raises(BadCameraFile, match=why):
        read_camera(write_text("a.yml", OLD.replace(old, new)), "opencv")


def test_prism_terms_are_refused(write_text):
    k = ", ".join(["0.1"] * 12)
    text = OLD.replace("rows: 4", "rows: 12").replace(".1, -2e-1, 3.e-3, 4.E-04", k)
    with pytest.raises(
        BadCameraFile, match=r"thin-prism or tilted-sensor terms \(after k6\) are not supported"
    ):
        read_camera(write_text("a.yml", text))


def test_a_ros_file_is_not_taken_for_opencv(write_text):
    with pytest.raises(BadCameraFile, match="read it as ros"):
        read_camera(write_text("a.yml", OLD + "distortion_model: equidistant\n"), "opencv")
