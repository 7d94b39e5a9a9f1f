"""MATLAB's parameters: row vectors, pixels from one, and the worked example of the project's origin."""

import json

import numpy as np
import pytest
from scipy import io

from vision_robot.errors import BadCameraFile
from vision_robot.formats import read_camera, write_camera
from vision_robot.geometry import Camera

# The origin's published matrix, as MATLAB exported it.
WORKED = """
IntrinsicMatrix = [1064 0 0; -0.8118 1065.8 0; 258.3899 295.171 1];
"""

CAMERA = Camera(640, 480, 700.5, 701.25, 1 / 3 + 320, 241.1, -0.75, "brown5", (-0.2, 0.1, 1e-3, -2e-3, 0.05))

STRUCT = {
    "RadialDistortion": [-0.2, 0.1],
    "TangentialDistortion": [0.001, -0.002],
    "ImageSize": [480, 640],
    "NumRadialDistortionCoefficients": 2,
    "WorldUnits": "mm",
    "EstimateSkew": True,
    "IntrinsicMatrix": [[700, 0, 0], [0.5, 701, 0], [321, 241, 1]],
}
EXPECTED = Camera(640, 480, 700, 701, 320, 240, 0.5, "brown5", (-0.2, 0.1, 0.001, -0.002, 0))


def test_worked_example_of_the_origin(write_text):
    camera = read_camera(write_text("k.m", WORKED), size=(640, 480))
    # The transpose is taken, and MATLAB's principal point, counted from 1, moves to ours.
    assert camera == Camera(640, 480, 1064, 1065.8, 257.3899, 294.171, -0.8118)


def test_one_centred_pixels_of_matlab_are_zero_centred_here(write_text):
    camera = read_camera(write_text("k.m", WORKED), size=(640, 480))
    points = np.random.default_rng(0).uniform([-0.3, -0.3, 1], [0.3, 0.3, 2], (20, 3))
    transposed = np.array([[1064, 0, 0], [-0.8118, 1065.8, 0], [258.3899, 295.171, 1]])
    row_vectors = points @ transposed
    assert camera.project(points) + 1 == pytest.approx(row_vectors[:, :2] / row_vectors[:, 2:], abs=1e-9)


class TestForms:
    def test_json_of_to_struct(self, write_text):
        assert read_camera(write_text("a.json", json.dumps(STRUCT))) == EXPECTED
        assert read_camera(write_text("a.json", json.dumps({"params": {"Intrinsics": STRUCT}}))) == EXPECTED

    def test_newer_k_is_not_transposed(self, write_text):
        fields = {**STRUCT, "K": [[700, 0.5, 321], [0, 701, 241], [0, 0, 1]]}
        del fields["IntrinsicMatrix"]
        assert read_camera(write_text("a.json", json.dumps(fields))) == EXPECTED

    def test_printed_object(self, write_text):
        text = """
          cameraIntrinsics with properties:

                     FocalLength: [700 701]
                  PrincipalPoint: [321 241]
                       ImageSize: [480 640]
                RadialDistortion: [-0.2000 0.1000]
            TangentialDistortion: [1.0000e-03 -0.0020]
                            Skew: 0.5000
                               K: [3x3 double]
        """
        text = text.replace("                               K: [3x3 double]\n", "")
        assert read_camera(write_text("a.txt", text)) == EXPECTED

    def test_script_over_several_lines(self, write_text):
        text = """% a comment: Skew = 7
        params.IntrinsicMatrix = [700, 0, 0; ...
                                  0.5, 701, 0
                                  321, 241, 1];
        params.ImageSize = [480 640]; params.RadialDistortion = [9 9];
        params.RadialDistortion = [-0.2 0.1 0];
        params.TangentialDistortion = [0.001 -0.002];
        """
        assert read_camera(write_text("a.m", text)) == EXPECTED

    @pytest.mark.parametrize("compressed", [False, True])
    @pytest.mark.parametrize("inside", [False, True])
    def test_mat_written_by_scipy(self, tmp_path, compressed, inside):
        arrays = {key: value for key, value in STRUCT.items() if key != "EstimateSkew"}
        content = {"notes": "text", "cells": np.array([[1]], dtype=object), "params": arrays}
        io.savemat(tmp_path / "a.mat", content if inside else arrays, do_compression=compressed)
        assert read_camera(tmp_path / "a.mat") == EXPECTED

    def test_scipy_reads_our_mat(self, tmp_path):
        write_camera(CAMERA, tmp_path / "a.mat")
        fields = io.loadmat(tmp_path / "a.mat")
        K = CAMERA.K + np.array([[0, 0, 1], [0, 0, 1], [0, 0, 0]])
        assert fields["IntrinsicMatrix"] == pytest.approx(K.T, rel=1e-15)
        assert fields["PrincipalPoint"] == pytest.approx(
            np.array([[CAMERA.cx + 1, CAMERA.cy + 1]]), rel=1e-15
        )
        assert fields["RadialDistortion"].tolist() == [[-0.2, 0.1, 0.05]]
        assert fields["TangentialDistortion"].tolist() == [[1e-3, -2e-3]]
        assert fields["ImageSize"].tolist() == [[480, 640]]

    def test_our_json_is_a_struct_for_jsondecode(self, tmp_path):
        write_camera(CAMERA, tmp_path / "a.json", "matlab")
        fields = json.loads((tmp_path / "a.json").read_text())
        assert fields["IntrinsicMatrix"][1] == [-0.75, 701.25, 0]
        assert fields["Skew"] == -0.75
        assert fields["ImageSize"] == [480, 640]


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (
            "IntrinsicMatrix = [700 0 320; 0 700 240; 0 0 1]",
            r"the row-vector form \[fx 0 0; s fy 0; cx cy 1\]",
        ),
        ("IntrinsicMatrix = [700 0 0; 0 700 0; 320 240]", "IntrinsicMatrix: 9 numbers expected, 8 found"),
        (
            "IntrinsicMatrix = [700 0 0; 0 NaN 0; 320 240 1]",
            r"IntrinsicMatrix\[4\]: a finite number expected, 'NaN'",
        ),
        (WORKED + "RadialDistortion = [1 2 3 4]", "RadialDistortion: 2 or 3 numbers expected, 4 found"),
        (WORKED, r"give size=\(width, height\)"),
        ("FocalLength = [1 2]", "PrincipalPoint is missing"),
    ],
)
def test_faults_are_named(write_text, text, why):
    with pytest.raises(BadCameraFile, match=why):
        read_camera(write_text("a.m", text), "matlab")


def test_objects_and_newer_mat_files_say_how_to_save(tmp_path):
    path = tmp_path / "a.mat"
    io.savemat(path, {"text": "no numbers"})
    with pytest.raises(BadCameraFile, match="toStruct"):
        read_camera(path)
    path.write_bytes(b"MATLAB 7.3 MAT-file".ljust(512))
    with pytest.raises(BadCameraFile, match="save with -v7"):
        read_camera(path)


def test_mat_that_unpacks_without_end_is_refused(tmp_path):
    io.savemat(tmp_path / "a.mat", {"K": np.zeros((3000, 3000))}, do_compression=True)
    assert (tmp_path / "a.mat").stat().st_size < 1_000_000
    with pytest.raises(BadCameraFile, match="unpacks to more than 16 MB"):
        read_camera(tmp_path / "a.mat")


def test_empty_mat_of_endless_height_is_refused_at_once(tmp_path):
    io.savemat(tmp_path / "a.mat", {"K": np.zeros((1234567, 0))})
    content = (tmp_path / "a.mat").read_bytes()
    big = content.replace((1234567).to_bytes(4, "little"), (2**31 - 1).to_bytes(4, "little"))
    assert big != content
    (tmp_path / "a.mat").write_bytes(big)
    with pytest.raises(BadCameraFile, match="K: 9 numbers expected, 0 found"):
        read_camera(tmp_path / "a.mat")
