"""A work plane and a camera's covariance come back from their files bit for bit, and faults are named."""

import json

import numpy as np
import pytest

from vision_robot.errors import BadCameraFile
from vision_robot.formats import read_camera, read_known_camera, write_camera, write_known_camera
from vision_robot.formats.work_plane import read_work_plane, write_work_plane
from vision_robot.geometry import SE3, Camera, KnownCamera, WorkPlane

CAMERA = Camera(640, 480, 500, 501, 320, 240, 0.25, "brown5", (1e-5, 0.2, 0.3, 0.4, 0.5))
POSE = SE3.from_rotvec(np.array([2.4, -0.2, 0.1]), np.array([0.02, -0.05, 0.8]))


def some_covariance(size: int) -> np.ndarray:
    root = np.random.default_rng(1).normal(size=(size, size)) * np.geomspace(1, 1e-5, size)
    return root.T @ root


def test_a_plane_comes_back(tmp_path):
    plane = WorkPlane(CAMERA, POSE, some_covariance(16))
    write_work_plane(plane, tmp_path / "plane.json")
    back = read_work_plane(tmp_path / "plane.json")
    assert back.camera == CAMERA
    assert np.allclose(back.cam_from_station.as_matrix(), POSE.as_matrix(), atol=1e-15)
    assert np.allclose(back.covariance, plane.covariance, rtol=1e-12)
    assert json.loads((tmp_path / "plane.json").read_text())["schema"] == "vr.plane/1"
    known = read_known_camera(tmp_path / "plane.json")
    assert known.camera == CAMERA
    assert np.allclose(known.covariance, plane.covariance[:10, :10], rtol=1e-12)


def test_a_camera_keeps_its_covariance_in_our_format_only(tmp_path):
    known = KnownCamera(CAMERA, some_covariance(10))
    write_known_camera(known, tmp_path / "a.json")
    back = read_known_camera(tmp_path / "a.json")
    assert np.allclose(back.covariance, known.covariance, rtol=1e-12)
    assert back.camera == read_camera(tmp_path / "a.json") == CAMERA
    write_known_camera(known, tmp_path / "a.mat")
    assert read_known_camera(tmp_path / "a.mat").taken_as_exact
    write_camera(CAMERA, tmp_path / "b.json")
    assert read_known_camera(tmp_path / "b.json").taken_as_exact


def test_a_plane_without_covariance_is_exact(tmp_path):
    write_work_plane(WorkPlane.exact(CAMERA, POSE), tmp_path / "plane.json")
    content = json.loads((tmp_path / "plane.json").read_text())
    del content["covariance"]
    (tmp_path / "plane.json").write_text(json.dumps(content))
    assert not read_work_plane(tmp_path / "plane.json").covariance.any()


@pytest.mark.parametrize(
    ("key", "value", "why"),
    [
        ("cam_from_station", None, "cam_from_station: keys with values expected"),
        ("cam_from_station", {"rotvec_rad": [0, 0, 0]}, "cam_from_station: translation_m is missing"),
        ("covariance", {"parameters": ["fx"], "matrix": [[1.0]]}, "fy, cx, .*missing"),
        ("covariance", {"parameters": "fx", "matrix": [[1.0]]}, "a list of names expected"),
    ],
)
def test_faults_are_named(tmp_path, key, value, why):
    write_work_plane(WorkPlane.exact(CAMERA, POSE), tmp_path / "plane.json")
    content = {**json.loads((tmp_path / "plane.json").read_text()), key: value}
    (tmp_path / "plane.json").write_text(json.dumps(content))
    with pytest.raises(BadCameraFile, match=why):
        read_work_plane(tmp_path / "plane.json")


def test_a_camera_file_is_no_plane_and_a_wrong_matrix_no_covariance(tmp_path):
    write_camera(CAMERA, tmp_path / "a.json")
    with pytest.raises(BadCameraFile, match="vr extrinsics plane -o"):
        read_work_plane(tmp_path / "a.json")
    write_work_plane(WorkPlane(CAMERA, POSE, some_covariance(16)), tmp_path / "plane.json")
    content = json.loads((tmp_path / "plane.json").read_text())
    content["covariance"]["matrix"][0][1] += 100
    (tmp_path / "plane.json").write_text(json.dumps(content))
    with pytest.raises(BadCameraFile, match=r"covariance.matrix: .*symmetric"):
        read_work_plane(tmp_path / "plane.json")
