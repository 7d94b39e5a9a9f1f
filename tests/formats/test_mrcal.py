"""mrcal's .cameramodel: files as mrcal writes them, and mrcal itself where it is installed."""

import numpy as np
import pytest

from vision_robot.errors import BadCameraFile
from vision_robot.formats import read_camera, write_camera
from vision_robot.geometry import Camera

# mrcal 2.4 and earlier; from mrcal's own tests.
OLD = """# generated on 2020-11-14
{
    'lensmodel':  'LENSMODEL_OPENCV8',

    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....
    'intrinsics': [ 1761.181055, 1761.250444, 1965.706996, 1087.518797, -0.01266096516, 0.03590794372, -0.0002547045941, 0.0005275929652, 0.01968883397, 0.01482863541, -0.0562239888, 0.0500223357,],

    # extrinsics are rt_fromref
    'extrinsics': [ 2e-2, -3e-1, -1e-2,  1., 2, -3., ],

    'imagersize': [ 4000, 2200 ]
}
"""  # noqa: E501

# mrcal 2.5, with the inputs of the optimisation in base 85.
NEW = """{
    'lensmodel':  'LENSMODEL_OPENCV4',
    'intrinsics': [ 500, 501, 320, 240, 0.1, 0.2, 0.03, 0.04,],
    'valid_intrinsics_region': [
    [ 0, 0 ],
    [ 9, 9 ],
    ],
    'rt_cam_ref': [ 0, 0, 0, 0, 0, 0,],
    'extrinsics': [ 0, 0, 0, 0, 0, 0,], # for compatibility with mrcal < 2.5
    'imagersize': [ 640, 480,],
    'icam_intrinsics': 0,
    'optimization_inputs': b'P)h>@6aWAK2mk;8ApigX{}#_!$&;<=>?@^`~',
}
"""

CAMERAS = [
    Camera(640, 480, 500.25, 501, 320.3, 240.1),
    Camera(640, 480, 500.25, 501, 320.3, 240.1, 0, "brown5", (-0.2, 0.1, 1e-3, -2e-3, 0.05)),
    Camera(
        640, 480, 500.25, 501, 320.3, 240.1, 0, "brown8", (-0.2, 0.1, 1e-3, -2e-3, 0.05, 0.1, 0.02, 0.003)
    ),
]


def test_file_of_mrcals_tests(write_text):
    camera = read_camera(write_text("cam0.opencv8.cameramodel", OLD))
    assert (camera.width, camera.height, camera.model) == (4000, 2200, "brown8")
    assert camera.parameters.tolist()[:5] == [1761.181055, 1761.250444, 1965.706996, 1087.518797, 0]
    assert camera.distortion[4:] == (0.01968883397, 0.01482863541, -0.0562239888, 0.0500223357)


def test_newer_file_with_region_and_inputs(write_text):
    expected = Camera(640, 480, 500, 501, 320, 240, 0, "brown5", (0.1, 0.2, 0.03, 0.04, 0))
    assert read_camera(write_text("a.cameramodel", NEW)) == expected


@pytest.mark.parametrize("camera", CAMERAS, ids=lambda camera: camera.model)
def test_mrcal_reads_and_projects_the_same(tmp_path, camera):
    mrcal = pytest.importorskip("mrcal")
    path = tmp_path / "a.cameramodel"
    write_camera(camera, path)
    model = mrcal.cameramodel(str(path))
    points = np.random.default_rng(0).uniform([-0.5, -0.4, 1], [0.5, 0.4, 2], (50, 3))
    assert mrcal.project(points, *model.intrinsics()) == pytest.approx(camera.project(points), abs=1e-9)
    model.write(str(tmp_path / "theirs.cameramodel"))
    # mrcal writes ten digits.
    assert read_camera(tmp_path / "theirs.cameramodel").parameters == pytest.approx(
        camera.parameters, rel=1e-9
    )


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        (
            "LENSMODEL_OPENCV4",
            "LENSMODEL_CAHVOR",
            "lensmodel LENSMODEL_CAHVOR is not supported: one of LENSMODEL_P",
        ),
        ("LENSMODEL_OPENCV4", "LENSMODEL_OPENCV5", "intrinsics: 9 numbers expected, 8 found"),
        ("[ 640, 480,]", "[ 640.5, 480,]", "imagersize: two whole numbers expected"),
        ("501", "__import__('os')", "intrinsics"),
        ("0.04,],", "0.04,", "intrinsics is missing or has no end"),
        ("'imagersize'", "'size'", "imagersize is missing"),
        ("'lensmodel'", "'lens'", "lensmodel is missing"),
        ("~',\n}\n", "", "is it truncated"),
    ],
)
def test_faults_are_named(write_text, old, new, why):
    with pytest.raises(BadCameraFile, match=why):
        read_camera(write_text("a.cameramodel", NEW.replace(old, new)), "mrcal")
