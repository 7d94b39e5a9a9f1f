"""The synthetic calibration set: truth that holds, bytes that repeat, folders never half-written."""

import hashlib
import json

import cv2
import numpy as np
import pytest

from vision_robot.calibrate.boards import Chessboard
from vision_robot.errors import BadParameter, UnwritableOutput
from vision_robot.geometry import SE3, Camera
from vision_robot_synth.calibration import TRUTH, CalibrationSet, board_print, calibration_set
from vision_robot_synth.calibration_folder import write_calibration_set
from vision_robot_synth.sensor import Sensor

SMALL = Camera(480, 360, 380, 376, 246.2, 171.3, 0.0, "brown5", (-0.25, 0.09, 0.0006, -0.0004, -0.01))
BOARD = Chessboard(6, 5, 0.03)


def small_set(**options) -> CalibrationSet:
    return calibration_set(SMALL, BOARD, views=3, **options)


def digests(folder) -> dict[str, str]:
    files = sorted(p for p in folder.rglob("*") if p.is_file())
    return {str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


def test_default_truth_is_an_ordinary_unsymmetric_camera():
    views = calibration_set(views=4)
    assert views.camera == TRUTH
    assert (TRUTH.width, TRUTH.height, TRUTH.model) == (1280, 960, "brown5")
    assert TRUTH.fx != TRUTH.fy
    assert abs(TRUTH.cx - 639.5) > 10
    assert abs(TRUTH.cy - 479.5) > 10
    assert views.corners.shape == (4, 54, 2)
    assert np.isfinite(views.corners).all()
    assert len(views) == 4


def test_truth_holds_in_the_pictures():
    """The detector finds the true corners to 0.1 px in noisy pictures, unbiased."""
    views = small_set(seed=2)
    errors = []
    for image, truth in zip(views.images(), views.corners, strict=True):
        assert image.shape == (360, 480)
        assert image.dtype == np.uint8
        found = BOARD.detect(image)
        assert found is not None
        errors.append(found.pixels - truth[found.ids])
    errors = np.concatenate(errors)
    assert np.sqrt(np.mean(errors**2)) < 0.06
    assert np.abs(errors.mean(axis=0)).max() < 0.015


def test_images_repeat_and_can_be_asked_for_in_part():
    views = small_set(seed=7)
    everything, again = list(views.images()), list(views.images())
    assert all((a == b).all() for a, b in zip(everything, again, strict=True))
    (last,) = views.images(slice(2, None))
    assert (last == everything[2]).all()
    assert list(views.images(slice(3, None))) == []
    other = next(small_set(seed=8).images())
    assert (other != everything[0]).any()


def test_noise_and_blur_are_what_they_say():
    flat = np.full((200, 200), 120, dtype=np.uint8)
    noisy = Sensor(blur_px=0, noise=2.0).expose(flat, np.random.default_rng(0))
    assert abs(noisy.std() - np.hypot(2.0, 1 / np.sqrt(12))) < 0.03
    assert abs(noisy.mean() - 120) < 0.05
    step = np.where(np.arange(40) < 20, 20, 220).astype(np.uint8)[None].repeat(9, axis=0)
    soft = Sensor(blur_px=1.0, noise=0).expose(step, np.random.default_rng(0))[4].astype(float)
    spread = np.diff(soft)
    centre = (np.arange(39) * spread).sum() / spread.sum()
    assert np.isclose(centre, 19, atol=0.01)
    assert np.isclose((((np.arange(39) - centre) ** 2) * spread).sum() / spread.sum(), 1, atol=0.1)
    clean = Sensor(blur_px=0, noise=0)
    assert (clean.expose(flat, np.random.default_rng(0)) == flat).all()


@pytest.mark.parametrize("options", [{"seed": -1}, {"views": 0}])
def test_impossible_sets_are_refused(options):
    with pytest.raises(BadParameter):
        calibration_set(SMALL, BOARD, **options)
    with pytest.raises(BadParameter):
        Sensor(noise=-1.0)


def test_print_puts_the_first_corner_at_the_origin():
    board = board_print(BOARD)
    left, top, right, bottom = board.box_m
    assert np.allclose((left, top), (-0.06, -0.06))
    assert np.allclose((right - left, bottom - top), BOARD.size_m)
    x, y = (np.array(board.origin_m) * board.pixels_per_metre).round().astype(int)
    around = board.picture[y - 2 : y + 2, x - 2 : x + 2]
    assert (around == np.kron([[0, 255], [255, 0]], np.ones((2, 2)))).all()


def test_large_boards_get_a_coarser_print():
    assert max(board_print(Chessboard(60, 20, 0.01)).picture.shape) <= 4096


def test_folder_holds_the_truth(tmp_path):
    views = small_set(seed=1)
    path = write_calibration_set(views, tmp_path / "set")
    described = json.loads(path.read_text())
    assert described["schema"] == "vr.dataset/1"
    assert described["recipe"] == "calibration"
    assert described["seed"] == 1
    assert described["renderer"]
    assert set(described["versions"]) == {"vision_robot", "mujoco", "numpy", "opencv"}
    stored = described["camera"]
    assert Camera(**{**stored, "distortion": tuple(stored["distortion"])}) == SMALL
    poses = [view["cam_from_board"] for view in described["views"]]
    rebuilt = SE3.from_rotvec(
        np.array([p["rotvec_rad"] for p in poses]), np.array([p["translation_m"] for p in poses])
    )
    assert np.allclose(rebuilt.as_matrix(), views.cam_from_board.as_matrix(), atol=1e-14)
    for view, image in zip(described["views"], views.images(), strict=True):
        assert (cv2.imread(str(tmp_path / "set" / view["image"]), cv2.IMREAD_UNCHANGED) == image).all()
    table = (tmp_path / "set" / described["corners"]).read_text().splitlines()
    assert table[0] == "image,id,u_px,v_px"
    assert len(table) == 1 + 3 * 30
    name, point, u, v = table[1 + 30 + 4].split(",")
    assert (name, point) == (described["views"][1]["image"], "4")
    assert np.allclose([float(u), float(v)], views.corners[1, 4], atol=1e-8)


def test_same_seed_same_bytes_and_a_second_run_does_nothing(tmp_path):
    path = write_calibration_set(small_set(), tmp_path / "a")
    write_calibration_set(small_set(), tmp_path / "b")
    assert digests(tmp_path / "a") == digests(tmp_path / "b")
    before = path.stat().st_mtime_ns
    write_calibration_set(small_set(), tmp_path / "a")
    assert path.stat().st_mtime_ns == before
    assert {p.name for p in tmp_path.iterdir()} == {"a", "b"}


def test_a_killed_run_leaves_nothing_in_place_and_goes_on_where_it_stopped(tmp_path, monkeypatch):
    """Killed after two frames: no folder yet; the next run renders only the third."""
    complete = write_calibration_set(small_set(), tmp_path / "complete").parent
    expose, calls = Sensor.expose, []

    def dying(self, image, rng):
        calls.append(1)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return expose(self, image, rng)

    monkeypatch.setattr(Sensor, "expose", dying)
    with pytest.raises(KeyboardInterrupt):
        write_calibration_set(small_set(), tmp_path / "set")
    assert not (tmp_path / "set").exists()
    write_calibration_set(small_set(), tmp_path / "set")
    assert len(calls) == 4
    assert digests(tmp_path / "set") == digests(complete)
    assert {p.name for p in tmp_path.iterdir()} == {"complete", "set"}


def test_another_set_or_a_stranger_s_files_are_never_overwritten(tmp_path):
    stranger = tmp_path / "mine"
    stranger.mkdir()
    (stranger / "thesis.txt").write_text("do not touch")
    with pytest.raises(UnwritableOutput, match="something else"):
        write_calibration_set(small_set(), stranger)
    assert [p.name for p in stranger.iterdir()] == ["thesis.txt"]
    (tmp_path / "file").write_text("")
    with pytest.raises(UnwritableOutput):
        write_calibration_set(small_set(), tmp_path / "file")
    empty = tmp_path / "empty"
    empty.mkdir()
    assert write_calibration_set(small_set(), empty).is_file()
    with pytest.raises(UnwritableOutput, match="something else"):
        write_calibration_set(small_set(seed=5), empty)
