"""Kalibr's camchain: chains of cameras, the lenses it shares with us, the others refused by name."""

import pytest

from vision_robot.errors import BadCameraFile, BadParameter
from vision_robot.formats import read_camera, read_cameras, write_camera
from vision_robot.geometry import Camera

CHAIN = """cam0:
  camera_model: pinhole
  intrinsics: [461.629, 460.152, 362.680, 246.049]
  distortion_model: radtan
  distortion_coeffs: [-0.27695497, 0.06712482, 0.00087538, 0.00011556]
  T_cam_imu:
  - [0.01779318, 0.99967549,-0.01822936, 0.07008565]
  - [-0.9998017, 0.01795239, 0.00860714,-0.01771023]
  - [0.00893160, 0.01807260, 0.99979678, 0.00399246]
  - [0.0, 0.0, 0.0, 1.0]
  timeshift_cam_imu: -8.121e-05
  rostopic: /cam0/image_raw
  resolution: [752, 480]
cam1:
  cam_overlaps: [0]
  camera_model: pinhole
  intrinsics: [190.97, 190.98, 254.93, 256.89]
  distortion_model: equidistant
  distortion_coeffs: [0.0034, 0.0007, -0.0020, 0.0002]
  rostopic: /cam1/image_raw
  resolution: [512, 512]
"""

CAM0 = Camera(
    752,
    480,
    461.629,
    460.152,
    362.68,
    246.049,
    0,
    "brown5",
    (-0.27695497, 0.06712482, 0.00087538, 0.00011556, 0),
)
CAM1 = Camera(512, 512, 190.97, 190.98, 254.93, 256.89, 0, "fisheye", (0.0034, 0.0007, -0.0020, 0.0002))


def test_published_chain(write_text):
    path = write_text("camchain.yaml", CHAIN)
    assert read_cameras(path) == {"cam0": CAM0, "cam1": CAM1}
    assert read_camera(path, name="cam1") == CAM1


def test_one_of_several_must_be_chosen(write_text):
    path = write_text("camchain.yaml", CHAIN)
    with pytest.raises(BadParameter, match="is None: it must be one of cam0, cam1"):
        read_camera(path)
    with pytest.raises(BadParameter, match="is 'cam7': it must be one of cam0, cam1"):
        read_camera(path, name="cam7")


def test_no_distortion(tmp_path):
    camera = Camera(752, 480, 461, 460, 362, 246)
    write_camera(camera, tmp_path / "a.yaml", "kalibr")
    assert "distortion_model: none" in (tmp_path / "a.yaml").read_text()
    assert read_camera(tmp_path / "a.yaml") == camera


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        (
            "camera_model: pinhole",
            "camera_model: omni",
            "cam0.camera_model: 'omni' is not supported: pinhole",
        ),
        ("radtan", "fov", "cam0.distortion_model: 'fov' is not supported: one of none, radtan, equidistant"),
        ("[752, 480]", "[752.5, 480]", "cam0.resolution: two whole numbers expected"),
        ("[752, 480]", "[752]", "cam0.resolution: 2 numbers expected, 1 found"),
        ("[0.0034, 0.0007, ", "[", "cam1.distortion_coeffs: 4 numbers expected, 2 found"),
        ("  resolution: [512, 512]\n", "", "cam1: resolution is missing"),
    ],
)
def test_faults_are_named(write_text, old, new, why):
    with pytest.raises(BadCameraFile, match=why):
        read_cameras(write_text("camchain.yaml", CHAIN.replace(old, new)))
