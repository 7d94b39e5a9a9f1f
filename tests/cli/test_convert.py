"""`vr convert` between every pair of formats, for rigs, and for files of no use."""

import itertools
import json

import numpy as np
import pytest

from vision_robot.formats import FORMATS, read_camera, read_known_camera, write_camera, write_known_camera
from vision_robot.formats.rig import read_rig, write_rig
from vision_robot.geometry import SE3, Camera, CameraRig, KnownCamera
from vision_robot_cli.main import run

CAMERA = Camera(640, 480, 500.25, 501.125, 1 / 3 + 320, 240.1, 0, "brown5", (-0.2, 0.1, 1e-3, -2e-3, 0))
SUFFIX = {"colmap": ".txt", "mrcal": ".cameramodel", "native": ".json", "matlab": ".m"}


def suffix(name: str) -> str:
    return SUFFIX.get(name, ".yaml")


@pytest.mark.parametrize(("first", "second"), list(itertools.permutations(FORMATS, 2)))
def test_every_pair_is_exact(tmp_path, capsys, first, second):
    source, target = tmp_path / f"a{suffix(first)}", tmp_path / f"b{suffix(second)}"
    write_camera(CAMERA, source, first)
    assert run(["convert", str(source), "--to", second, "-o", str(target), "--json"]) == 0
    done = json.loads(capsys.readouterr().out)
    assert done["schema"] == "vr.convert/1"
    assert done["read_back_shift_px"] == 0
    assert read_camera(target) == CAMERA


def test_the_covariance_travels_in_our_own_format_only(tmp_path, capsys):
    write_known_camera(KnownCamera(CAMERA, np.diag(np.arange(10.0))), tmp_path / "a.json")
    assert run(["convert", str(tmp_path / "a.json"), "-o", str(tmp_path / "b.json")]) == 0
    assert read_known_camera(tmp_path / "b.json").covariance[3, 3] == 3
    assert run(["convert", str(tmp_path / "a.json"), "-o", str(tmp_path / "b.yaml")]) == 0
    assert "no place for the covariance" in capsys.readouterr().err


def test_rigs_stay_rigs(tmp_path, capsys):
    poses = SE3.from_rotvec(np.array([[0, 0, 0], [0.1, 0.2, 0.3]]), np.array([[0, 0, 0], [0.1, 0, 0.0]]))
    rig = CameraRig.exact(("cam0", "cam1"), (CAMERA, CAMERA), poses)
    write_rig(rig, tmp_path / "chain.yaml")
    folder = tmp_path / "models"
    assert run(["convert", str(tmp_path / "chain.yaml"), "--to", "mrcal", "-o", str(folder)]) == 0
    files = sorted(map(str, folder.iterdir()))
    assert run(["convert", *files, "-o", str(tmp_path / "rig.json"), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out.splitlines()[-1])["cameras"]) == 2
    back = read_rig([tmp_path / "rig.json"])
    assert np.abs(back.cam_from_rig.as_matrix() - poses.as_matrix()).max() < 1e-14
    one = ["convert", str(tmp_path / "rig.json"), "--camera-name", "cam1", "-o", str(tmp_path / "one.yaml")]
    assert run(one) == 0
    assert read_camera(tmp_path / "one.yaml") == CAMERA


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("hello", "its content is none of native, opencv"),
        ('{"schema": "vr.camera/1", "camera": {"width": 640', "line 1"),
        ("", "it is empty"),
        (
            "%YAML:1.0\n---\ncamera_matrix: !!opencv-matrix\n   rows: 3\n",
            "distortion_coefficients is missing",
        ),
        (
            "{ 'lensmodel': 'LENSMODEL_SPLINED_STEREOGRAPHIC_order=3', }",
            "SPLINED_STEREOGRAPHIC.*not supported",
        ),
    ],
)
def test_unknown_and_truncated_files_are_named(tmp_path, capsys, text, words):
    import re

    (tmp_path / "bad").write_text(text)
    assert run(["convert", str(tmp_path / "bad"), "-o", str(tmp_path / "out.json")]) == 2
    error = capsys.readouterr().err
    assert len(error.splitlines()) == 1
    assert re.search(words, error)
    assert not (tmp_path / "out.json").exists()


def test_what_a_format_cannot_hold_is_refused_unless_allowed(tmp_path, capsys):
    skewed = Camera(640, 480, 500, 500, 320, 240, 1.5)
    write_camera(skewed, tmp_path / "a.json")
    words = ["convert", str(tmp_path / "a.json"), "-o", str(tmp_path / "b.yaml")]
    assert run(words) == 2
    assert "0 in the opencv format" in capsys.readouterr().err
    assert run([*words, "--allow-loss"]) == 0
    assert read_camera(tmp_path / "b.yaml").skew == 0
    assert "size" in _refused(capsys, ["convert", str(_sizeless(tmp_path)), "-o", str(tmp_path / "c.json")])
    sized = ["convert", str(_sizeless(tmp_path)), "--image-size", "640x480", "-o", str(tmp_path / "c.json")]
    assert run(sized) == 0


def _sizeless(folder):
    (folder / "k.m").write_text("IntrinsicMatrix = [1064 0 0; -0.8118 1065.8 0; 258.3899 295.171 1];\n")
    return folder / "k.m"


def _refused(capsys, words) -> str:
    assert run(words) == 2
    return capsys.readouterr().err
