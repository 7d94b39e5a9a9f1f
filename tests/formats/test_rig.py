"""Rigs come back from every format that holds one, and mean to mrcal what they mean to us."""

import json

import numpy as np
import pytest

from vision_robot.errors import BadCameraFile, BadParameter
from vision_robot.formats import read_camera, read_cameras
from vision_robot.formats.rig import holds_rig, read_rig, write_rig
from vision_robot.geometry import SE3, Camera, CameraRig

CAMERAS = (
    Camera(640, 480, 500.25, 501, 320.3, 240.1),
    Camera(640, 480, 500.25, 501, 320.3, 240.1, 0, "brown5", (-0.2, 0.1, 1e-3, -2e-3, 0)),
    Camera(1280, 960, 900, 901, 640.3, 480.1, 0, "brown5", (-0.1, 0.1, 1e-3, -2e-3, 0)),
)
POSES = SE3.from_rotvec(
    np.array([[0, 0, 0], [0.02, 0.3, -0.05], [-0.3, -2.1, 0.1]]),
    np.array([[0, 0, 0], [-0.3, 0.01, 0.05], [0.1, 0.25, 0.05]]),
)
RIG = CameraRig.exact(("cam0", "cam1", "cam2"), CAMERAS, POSES)


@pytest.mark.parametrize(
    ("name", "files"),
    [("rig.json", 1), ("chain.yaml", 1), ("folder", 3)],
)
def test_a_rig_comes_back(tmp_path, name, files):
    written = write_rig(RIG, tmp_path / name)
    assert len(written) == files
    back = read_rig(written)
    assert back.names == RIG.names
    assert back.cameras == CAMERAS
    assert np.abs(back.cam_from_rig.as_matrix() - POSES.as_matrix()).max() < 1e-14
    assert holds_rig(written[0]) == (files == 1)


def test_only_ours_keeps_the_covariance(tmp_path):
    root = np.random.default_rng(0).normal(size=(len(RIG.covariance),) * 2)
    rig = CameraRig(RIG.names, CAMERAS, POSES, root @ root.T)
    back = read_rig(write_rig(rig, tmp_path / "rig.json"))
    assert np.allclose(back.covariance, rig.covariance, rtol=1e-12)
    assert not read_rig(write_rig(rig, tmp_path / "chain.yml")).covariance.any()
    assert read_cameras(tmp_path / "rig.json") == dict(zip(RIG.names, CAMERAS, strict=True))
    assert read_camera(tmp_path / "rig.json", name="cam1") == CAMERAS[1]


def test_kalibrs_link_carries_points_from_the_camera_before(write_text):
    """As in Kalibr's documentation: T_cn_cnm1 = T_c1_c0, here a baseline of 11 cm."""
    text = """cam0:
  camera_model: pinhole
  intrinsics: [461.6, 460.3, 363.0, 248.1]
  distortion_model: radtan
  distortion_coeffs: [-0.27, 0.06, 0.0, 0.0]
  resolution: [752, 480]
cam1:
  T_cn_cnm1:
  - [0.99998, -0.00152, 0.00633, -0.11003]
  - [0.00148, 0.99998, 0.00570, 0.00040]
  - [-0.00634, -0.00569, 0.99996, -0.00086]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  intrinsics: [460.0, 459.0, 374.0, 255.0]
  distortion_model: radtan
  distortion_coeffs: [-0.27, 0.06, 0.0, 0.0]
  resolution: [752, 480]
"""
    rig = read_rig([write_text("camchain.yaml", text)])
    assert rig.cam_from_rig.translation[1].tolist() == [-0.11003, 0.0004, -0.00086]
    # The other camera stands to the right of the first.
    assert rig.cam_from_rig.inverse().translation[1, 0] == pytest.approx(0.11, abs=1e-3)
    assert np.linalg.det(rig.cam_from_rig.rotation[1]) == pytest.approx(1, abs=1e-14)
    for old, new, why in [
        ("0.99996, -0.00086", "0.9, -0.00086", "cam1.T_cn_cnm1: no rotation"),
        ("0.0, 0.0, 0.0, 1.0", "0.0, 0.0, 0.0, 2.0", "its last row must be 0 0 0 1"),
        ("T_cn_cnm1", "T_cam_imu", "cam1: T_cn_cnm1 is missing"),
    ]:
        with pytest.raises(BadCameraFile, match=why):
            read_rig([write_text("bad.yaml", text.replace(old, new))])


def test_mrcal_sees_the_same_points(tmp_path):
    mrcal = pytest.importorskip("mrcal")
    points = np.random.default_rng(0).uniform([-0.2, -0.2, 1], [0.2, 0.2, 2], (50, 3))
    for i, file in enumerate(write_rig(RIG, tmp_path / "theirs")):
        model = mrcal.cameramodel(str(file))
        in_cam = mrcal.transform_point_rt(model.rt_cam_ref(), points)
        assert in_cam == pytest.approx(POSES[i].apply(points), abs=1e-12)
        model.write(str(file.with_name(f"again{i}.cameramodel")))
    again = read_rig(sorted((tmp_path / "theirs").glob("again*.cameramodel")))
    assert again.names == ("again0", "again1", "again2")
    assert np.abs(again.cam_from_rig.as_matrix() - POSES.as_matrix()).max() < 1e-9


def test_what_is_no_rig_is_refused(tmp_path, write_text):
    with pytest.raises(BadParameter, match="format of a rig is 'opencv'"):
        write_rig(RIG, tmp_path / "a.xml", "opencv")
    skewed = CameraRig.exact(("a",), (Camera(640, 480, 500, 500, 320, 240, 1.0),), SE3.identity(1))
    with pytest.raises(BadParameter, match="skew"):
        write_rig(skewed, tmp_path / "a.yaml")
    with pytest.raises(BadCameraFile, match="a rig is one file of ours"):
        read_rig([write_text("a.txt", "1 PINHOLE 640 480 500 500 320 240"), tmp_path / "a.txt"])
    written = write_rig(RIG, tmp_path / "rig.json")[0]
    content = json.loads(written.read_text())
    content["cameras"][1]["name"] = "cam0"
    with pytest.raises(BadCameraFile, match="rig: names"):
        read_rig([write_text("b.json", json.dumps(content))])
    with pytest.raises(BadCameraFile, match="cameras: a list"):
        read_rig([write_text("c.json", '{"schema": "vr.rig/1", "cameras": 3}')])
