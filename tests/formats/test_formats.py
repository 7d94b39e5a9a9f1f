"""Laws of all camera file formats: exact round trips, recognition, refusals, safety against damage."""

import time
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from vision_robot.errors import BadCameraFile, BadInput, BadParameter, UnwritableOutput, VisionRobotError
from vision_robot.formats import (
    FORMATS,
    SUFFIXES,
    format_named,
    read_camera,
    read_cameras,
    write_camera,
)
from vision_robot.formats.loss import fitted
from vision_robot.geometry import LENSES, Camera
from vision_robot.reading import LARGEST_TREE

BROWN = Camera(640, 480, 532.8, 533.1, 341.25, 233.7, 0.0, "brown5", (-0.28, 0.03, 1.2e-5, -3e-4, 0.12))
SKEWED = Camera(640, 480, 1064, 1065.8, 257.3899, 294.171, -0.8118)
WIDE = Camera(1280, 960, 400.5, 401, 640, 480, 0, "fisheye", (0.01, -0.02, 0.003, -0.0004))

SUFFIXES_OF = {
    "native": (".json",),
    "opencv": (".yml", ".json", ".xml"),
    "ros": (".yaml",),
    "kalibr": (".yaml",),
    "colmap": (".txt",),
    "mrcal": (".cameramodel",),
    "matlab": (".json", ".m", ".mat"),
}
FORMS = [(name, suffix) for name, suffixes in SUFFIXES_OF.items() for suffix in suffixes]

quick = settings(
    max_examples=40,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
    derandomize=True,
)


def intrinsics(name: str) -> st.SearchStrategy[dict]:
    """Fields of cameras the format called `name` holds without loss, over every lens it knows.

    Not the cameras themselves: the run-time type checks of the tests draw random numbers, which
    Hypothesis forbids while it draws its own.
    """
    target = format_named(name)

    def of_model(model: str) -> st.SearchStrategy[dict]:
        coefficient = st.floats(-2, 2).filter(lambda k: k != 0)
        names = LENSES[model].coefficient_names
        k = [coefficient if c in target.lenses[model] else st.just(0.0) for c in names]
        return st.builds(
            dict,
            width=st.integers(1, 100_000),
            height=st.integers(1, 100_000),
            fx=st.floats(1e-3, 1e7),
            fy=st.floats(1e-3, 1e7),
            cx=st.floats(-1e6, 1e6).map(lambda c: c + 0.0 if abs(c) > 1e-30 else 0.0),
            cy=st.floats(-1e6, 1e6).map(lambda c: c + 0.0 if abs(c) > 1e-30 else 0.0),
            skew=st.floats(-1e3, 1e3) if target.skew else st.just(0.0),
            model=st.just(model),
            distortion=st.tuples(*k),
        )

    return st.sampled_from(sorted(target.lenses)).flatmap(of_model)


def sample(name: str) -> Camera:
    """A camera with a lens that the format holds."""
    return fitted(BROWN, name, format_named(name), allow_loss=True)


def written(folder: Path, name: str, suffix: str) -> Path:
    path = folder / f"{name}{suffix}"
    write_camera(sample(name), path, name)
    return path


def test_every_format_is_tried_here():
    assert list(SUFFIXES_OF) == list(FORMATS)
    assert set(SUFFIXES.values()) <= set(FORMATS)


@pytest.mark.parametrize(("name", "suffix"), FORMS)
@quick
@given(data=st.data())
def test_reading_what_was_written_gives_the_same_camera(tmp_path, name, suffix, data):
    camera = Camera(**data.draw(intrinsics(name)))
    path = tmp_path / f"camera{suffix}"
    write_camera(camera, path, name)
    back = read_camera(path, name)
    if suffix == ".mat":
        # Binary floats cannot hold cx + 1 exactly: half a unit in the last place each way.
        assert back.parameters == pytest.approx(camera.parameters, rel=1e-15, abs=3e-16 + 3e-16)
    else:
        assert back == camera


@pytest.mark.parametrize(("name", "suffix"), FORMS)
def test_content_is_recognised_whatever_the_name(tmp_path, name, suffix):
    path = written(tmp_path, name, suffix)
    blind = path.rename(tmp_path / "something.dat")
    assert read_camera(blind) == sample(name)
    for other in FORMATS:
        if other != name:
            with pytest.raises(BadCameraFile):
                read_camera(blind, other)


@pytest.mark.parametrize("suffix", sorted(SUFFIXES))
def test_suffix_chooses_the_format_written(tmp_path, suffix):
    camera = SKEWED.without_distortion() if SUFFIXES[suffix] == "matlab" else BROWN
    path = tmp_path / f"camera{suffix}"
    write_camera(camera, path)
    assert read_camera(path, SUFFIXES[suffix]).parameters == pytest.approx(camera.parameters, rel=1e-15)


class TestLoss:
    """What a format has no place for."""

    @pytest.mark.parametrize("name", ["opencv", "ros", "kalibr", "colmap", "mrcal"])
    def test_skew_is_refused_with_its_cost(self, tmp_path, name):
        path = tmp_path / "camera.txt"
        # |skew| max|v - cy| / fy = 0.8118 * 294.171 / 1065.8 = 0.224 px.
        with pytest.raises(BadParameter, match=r"camera skew is -0\.8118: it must be 0 .* up to 0\.22 px"):
            write_camera(SKEWED, path, name)
        assert not path.exists()
        write_camera(SKEWED, path, name, allow_loss=True)
        assert read_camera(path, name) == Camera(640, 480, 1064, 1065.8, 257.3899, 294.171)

    def test_k3_is_refused_by_kalibr(self, tmp_path):
        with pytest.raises(BadParameter, match=r"camera k3 is 0\.12: it must be 0 in the kalibr format"):
            write_camera(BROWN, tmp_path / "a.yaml", "kalibr")
        write_camera(BROWN, tmp_path / "a.yaml", "kalibr", allow_loss=True)
        assert read_camera(tmp_path / "a.yaml").distortion == (*BROWN.distortion[:4], 0.0)

    def test_rational_terms_are_named(self, tmp_path):
        camera = Camera(640, 480, 500, 500, 320, 240, 0, "brown8", (0.1, 0.2, 0, 0, 0.3, 0.4, 0.0, 0.6))
        with pytest.raises(BadParameter, match=r"camera k4, k6 is \(0\.4, 0\.6\)"):
            write_camera(camera, tmp_path / "a.m")

    @pytest.mark.parametrize("name", ["mrcal", "matlab"])
    def test_another_kind_of_lens_is_refused_even_with_loss(self, tmp_path, name):
        with pytest.raises(
            BadParameter, match=f"camera model is 'fisheye': it must be one of .* in the {name} format"
        ):
            write_camera(WIDE, tmp_path / "a.yml", name, allow_loss=True)

    def test_nothing_is_refused_that_loses_nothing(self, tmp_path):
        rational = Camera(640, 480, 500, 500, 320, 240, 0, "brown8", (0.1, 0.2, 0.01, 0, 0, 0, 0, 0))
        write_camera(rational, tmp_path / "a.yaml", "kalibr")
        assert read_camera(tmp_path / "a.yaml").distortion == (0.1, 0.2, 0.01, 0, 0)


class TestRefusals:
    """Files that are no camera files, each answered in one line."""

    def test_missing_folder_empty_and_large(self, tmp_path):
        empty, large = tmp_path / "empty.yml", tmp_path / "large.yml"
        empty.write_text(" \n")
        large.write_bytes(b"a" * (LARGEST_TREE + 1))
        for path, why in [
            (tmp_path / "none.yml", "there is no such file"),
            (tmp_path, "it is not a plain file"),
            (empty, "it is empty"),
            (large, "it is larger than 16 MB"),
            (Path("/dev/zero"), "it is not a plain file"),
        ]:
            with pytest.raises(BadCameraFile, match=why):
                read_camera(path)

    def test_unknown_content_and_names(self, tmp_path):
        path = tmp_path / "a.yml"
        path.write_text("just: some\nyaml: 1\n")
        with pytest.raises(BadCameraFile, match="its content is none of native, opencv, ros"):
            read_camera(path)
        with pytest.raises(BadParameter, match="camera format is 'openvc': it must be one of native, opencv"):
            read_camera(path, "openvc")
        with pytest.raises(BadParameter, match=r"suffix of a camera file is '\.png'"):
            write_camera(BROWN, tmp_path / "a.png")
        with pytest.raises(UnwritableOutput):
            write_camera(BROWN, tmp_path, "ros")

    @pytest.mark.parametrize(("name", "suffix"), FORMS)
    @pytest.mark.parametrize("number", ["nan", ".Nan", "inf", "-5.0", "1e999", "abc", "0x10", "0.0"])
    def test_impossible_focal_length(self, tmp_path, name, suffix, number):
        if suffix == ".mat":
            pytest.skip("binary")
        path = written(tmp_path, name, suffix)
        path.write_text(path.read_text().replace("532.8", number))
        with pytest.raises(BadCameraFile) as caught:
            read_camera(path, name)
        assert "\n" not in str(caught.value)

    @pytest.mark.parametrize(("name", "suffix"), FORMS)
    @pytest.mark.parametrize("width", ["0", "-640", "640.5", "1000000000", "many"])
    def test_absurd_size(self, tmp_path, name, suffix, width):
        if suffix == ".mat":
            pytest.skip("binary")
        path = written(tmp_path, name, suffix)
        path.write_text(path.read_text().replace("640", width))
        with pytest.raises(BadCameraFile):
            read_camera(path, name)

    def test_size_that_contradicts_the_file(self, tmp_path):
        path = written(tmp_path, "ros", ".yaml")
        assert read_camera(path, size=(640, 480)) == sample("ros")
        with pytest.raises(BadCameraFile, match="it is for 640x480 px, not 1280x720 px"):
            read_camera(path, size=(1280, 720))

    def test_broken_format_is_named(self, tmp_path, monkeypatch):
        monkeypatch.setitem(FORMATS, "broken", "vision_robot.formats.nowhere:FORMAT")
        with pytest.raises(VisionRobotError, match=r"camera format broken \(vision_robot.formats.nowhere"):
            format_named("broken")


class TestDamage:
    """Damaged files raise BadInput, at once and in one line; a shortened one never gives another camera."""

    @pytest.mark.parametrize(("name", "suffix"), FORMS)
    def test_every_truncation(self, tmp_path, name, suffix):
        whole = written(tmp_path, name, suffix).read_bytes()
        path = tmp_path / "cut"
        for end in range(0, len(whole), 2):
            path.write_bytes(whole[:end])
            try:
                cameras = read_cameras(path, name if end % 10 else None)
            except BadInput as error:
                message = str(error)
            else:
                message = ""
                assert list(cameras.values()) == [sample(name)]
            assert "\n" not in message

    @pytest.mark.parametrize(("name", "suffix"), FORMS)
    @settings(quick, max_examples=100)
    @given(data=st.data())
    def test_changed_bytes(self, tmp_path, name, suffix, data):
        content = bytearray(written(tmp_path, name, suffix).read_bytes())
        for _ in range(data.draw(st.integers(1, 6))):
            at = data.draw(st.integers(0, len(content) - 1))
            kind = data.draw(st.sampled_from(["set", "flip", "cut", "repeat"]))
            if kind == "set":
                content[at] = data.draw(st.integers(0, 255))
            elif kind == "flip":
                content[at] ^= 1 << data.draw(st.integers(0, 7))
            elif kind == "cut":
                del content[at + 1 : at + data.draw(st.integers(1, 20))]
            else:
                content[at:at] = content[at : at + data.draw(st.integers(1, 20))]
        path = tmp_path / "changed"
        path.write_bytes(content)
        for chosen in (None, name):
            with suppress(BadInput):
                read_cameras(path, chosen)

    @pytest.mark.parametrize("name", list(FORMATS))
    @quick
    @given(content=st.binary(min_size=1, max_size=300))
    def test_garbage(self, tmp_path, name, content):
        path = tmp_path / "garbage"
        path.write_bytes(content)
        with pytest.raises(BadCameraFile):
            read_cameras(path, name)

    @pytest.mark.parametrize(
        ("name", "content"),
        [
            ("opencv", b"camera_matrix: " + b"[" * 1_000_000),
            ("opencv", b"camera_matrix: " + b"{a: " * 100_000),
            ("opencv", b"- " * 200_000),
            ("opencv", b"camera_matrix: [" + b"1," * 1_000_000 + b"1]"),
            ("opencv", b'{"camera_matrix": ' + b"[" * 1_000_000),
            ("opencv", b"<opencv_storage>" + b"<a>" * 100_000),
            ("opencv", b'<!DOCTYPE a [<!ENTITY b "bbb">]><opencv_storage><camera_matrix>&b;</camera_matrix>'),
            ("opencv", b"camera_matrix: !!python/object/apply:os.system [exit 1]"),
            ("ros", b"distortion_model: *nowhere"),
            ("ros", b"a: &a [1,1]\nb: &b [*a,*a]\ndistortion_model: &c [*b,*b]\nK: *c"),
            ("ros", b"<<: {distortion_model: plumb_bob}"),
            ("mrcal", b"{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [" + b"1," * 1_000_000),
            ("mrcal", b"{" + b"'lensmodel':" * 200_000 + b"}"),
            ("matlab", b"IntrinsicMatrix = [" + b" " * 2_000_000),
            ("matlab", b"IntrinsicMatrix =" + b"\n" * 1_000_000),
            ("matlab", b"IntrinsicMatrix = [\n" * 200_000),
            ("mrcal", b"{'lensmodel': 'LENSMODEL_PINHOLE', " + b"'intrinsics': [" * 200_000 + b"}"),
            ("colmap", b"1 PINHOLE 640 480 " + b"9" * 2_000_000),
            ("native", b'{"fx": ' + b"9" * 2_000_000 + b"}"),
        ],
    )
    def test_bombs(self, tmp_path, name, content):
        path = tmp_path / "bomb"
        path.write_bytes(content)
        start = time.process_time()
        for chosen in (name, None):
            with pytest.raises(BadCameraFile) as caught:
                read_cameras(path, chosen)
            assert len(str(caught.value)) < 500
        assert time.process_time() - start < 5
