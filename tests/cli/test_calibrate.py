"""`vr calibrate` as a person runs it: rendered sets, real photos, corner files, and every bad input."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate.boards import Chessboard, raster
from vision_robot.formats import read_camera
from vision_robot.images import read_image
from vision_robot_cli.main import run


@pytest.fixture
def photos() -> list[str]:
    """The 14 photos of PyPI's mvtb-data, which nobody here took."""
    import mvtbdata

    folder = Path(mvtbdata.__file__).parent / "images" / "calibration"
    return [str(path) for path in sorted(folder.glob("left*.jpg"))]


def run_json(capsys, *arguments) -> dict:
    assert run(["calibrate", *map(str, arguments), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def refused(capsys, *arguments) -> str:
    """The one line that a bad input gets, with exit code 2 and nothing on stdout."""
    assert run(["calibrate", *map(str, arguments)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    lines = captured.err.strip().splitlines()
    assert len(lines) == 1, lines
    return lines[0]


def test_a_rendered_set_gives_the_true_camera(capsys):
    found = run_json(capsys)
    assert found["schema"] == "vr.calibrate/1"
    truth = found["truth"]
    assert abs(truth["fx_error_percent"]) <= 0.03
    assert truth["projection_error_px"]["rms"] <= 0.1
    true_values = dict(zip(("k1", "k2", "p1", "p2", "k3"), truth["camera"]["distortion"], strict=True))
    found_values = dict(zip(("k1", "k2", "p1", "p2", "k3"), found["camera"]["distortion"], strict=True))
    for name in ("fx", "fy", "cx", "cy"):
        assert abs(truth[f"{name}_error"]) <= 4 * found["sigma"][name], name
    for name, value in true_values.items():
        assert abs(found_values[name] - value) <= 4 * found["sigma"][name], name
    assert found["views_used"] == 24
    assert found["corners"] == 24 * 54


def test_real_photos_are_all_found_and_fit_as_well_as_opencv_fits_them(capsys, photos, tmp_path):
    found = run_json(capsys, *photos, "-o", tmp_path / "camera.yaml")
    assert found["views_used"] == 14
    assert found["views_rejected"] == []
    assert found["truth"] is None
    assert found["rms_px"] <= 0.165
    assert read_camera(tmp_path / "camera.yaml").fx == found["camera"]["fx"]

    board = Chessboard(9, 6, 0.025)
    views = [board.detect(read_image(path), name=path) for path in photos]
    pixels = [view.pixels.astype(np.float32) for view in views if view is not None]
    model = [board.points.astype(np.float32)] * len(pixels)
    theirs = cv2.calibrateCamera(model, pixels, (640, 480), None, None)[0]  # pyright: ignore
    assert found["rms_px"] <= theirs + 1e-6


def test_the_board_as_it_is_explains_real_photos_better(capsys, photos, tmp_path):
    report = tmp_path / "page.html"
    found = run_json(capsys, *photos, "--warp", "4", "--report", report)
    assert found["rms_px"] <= 0.09
    assert 2e-5 < found["board_warp_rms_m"] < 3e-4
    judgement = found["judgement"]
    assert judgement["unanswered"] == {}
    assert judgement["held_out_px"]["rms"] < 0.12
    assert len(judgement["next_views"]["views"]) == 5
    assert sum(line["px"] ** 2 for line in judgement["error_budget"]["lines"]) == pytest.approx(
        judgement["error_budget"]["total_px"] ** 2
    )
    text = report.read_text()
    assert "What to photograph next" in text
    assert "left08.jpg" in text


def test_corner_files_calibrate_without_pictures(capsys, tmp_path):
    views = make_views(CAMERAS["brown5"], 5)
    np.savetxt(tmp_path / "model.txt", views.board[:, :2] / 0.0254)
    (tmp_path / "corners").mkdir()
    for i, view in enumerate(views.corners):
        np.savetxt(tmp_path / "corners" / f"data{i}.txt", view.pixels.reshape(-1, 8))
    options = ("--corners", tmp_path / "corners", "--model-points", tmp_path / "model.txt")
    found = run_json(capsys, *options, "--skew")
    assert (found["camera"]["width"], found["camera"]["height"]) == (1280, 960)
    assert found["image_size_assumed"]
    assert abs(found["camera"]["fx"] - 1000) < 5 * found["sigma"]["fx"]
    assert abs(found["camera"]["skew"]) < 5 * found["sigma"]["skew"]
    fixed = run_json(capsys, *options, "--image-size", "1280x960", "--fix", "k3", "--fix", "p1=0.001")
    assert fixed["camera"]["distortion"][4] == 0
    assert fixed["camera"]["distortion"][2] == 0.001
    assert not fixed["image_size_assumed"]


def test_a_missed_limit_still_shows_the_result(capsys, tmp_path):
    views = make_views(CAMERAS["pinhole"], 4)
    np.savetxt(tmp_path / "model.txt", views.board[:, :2])
    (tmp_path / "corners").mkdir()
    for i, view in enumerate(views.corners):
        np.savetxt(tmp_path / "corners" / f"{i}.txt", view.pixels)
    words = ["calibrate", "--corners", tmp_path / "corners", "--model-points", tmp_path / "model.txt"]
    assert run([*map(str, words), "--model", "pinhole", "--max-rms", "0.01"]) == 3
    captured = capsys.readouterr()
    assert "fx" in captured.out
    assert "limit missed" in captured.err


def picture(folder: Path, name: str, *, columns=9, rows=6, size=None, tilt=0.0) -> Path:
    """A drawn board, seen straight or a little from the side."""
    grey = raster(Chessboard(columns, rows, 0.025).drawing(), 1600)
    height, width = grey.shape
    corners = np.array([[0, 0], [width, 0], [width, height], [0, height]], dtype=np.float32)
    seen = corners + np.array([[0, 0], [0, tilt * height], [0, -tilt * height], [0, 0]], dtype=np.float32)
    warp = cv2.getPerspectiveTransform(corners, seen)
    grey = cv2.warpPerspective(grey, warp, (width, height), borderValue=255)
    if size:
        grey = cv2.resize(grey, size, interpolation=cv2.INTER_AREA)
    path = folder / name
    cv2.imwrite(str(path), grey)
    return path


def test_bad_pictures_are_named(capsys, tmp_path):
    empty = tmp_path / "empty.png"
    empty.touch()
    assert "no image found" in refused(capsys, tmp_path / "nothing*.jpg")
    assert "empty.png cannot be read" in refused(capsys, empty)
    small = picture(tmp_path, "small.png", size=(400, 300))
    line = refused(capsys, picture(tmp_path, "a.png"), small)
    assert "small.png is 400x300" in line


def test_a_board_of_another_size_is_told(capsys, tmp_path):
    views = [picture(tmp_path, f"{i}.png", columns=7, rows=5, tilt=0.05 * i) for i in range(3)]
    line = refused(capsys, *views)
    assert "9x6" in line
    assert "7x5" in line


def test_degenerate_views_name_what_cannot_be_known(capsys, tmp_path):
    views = [picture(tmp_path, f"{i}.png") for i in range(4)]
    line = refused(capsys, *views)
    assert "cannot be known" in line
    assert "fx" in line
    assert "tilted" in line


def test_too_few_views(capsys, tmp_path):
    assert "1 usable view" in refused(capsys, picture(tmp_path, "one.png"))


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--square", "0mm"), "--square"),
        (("--square", "-25mm"), "--square"),
        (("--square", "twenty"), "--square"),
        (("--size", "9"), "--size"),
        (("--size", "1x1"), "chessboard"),
        (("--board", "dartboard"), "chessboard"),
        (("--model", "brown9"), "brown8"),
        (("--fix", "k9"), "k9"),
        (("--prior", "cx"), "cx=640"),
        (("--warp", "99"), "warp"),
        (("--corners", "/nowhere"), "--model-points"),
        (("--views", "many"), "views"),
        (("--nonsense",), "nonsense"),
    ],
)
def test_options_that_make_no_sense_are_refused_before_any_work(capsys, options, says):
    assert says in refused(capsys, *options)


def test_outputs_that_cannot_be_written_are_refused_before_any_work(capsys, tmp_path):
    blocked = tmp_path / "file"
    blocked.touch()
    assert "is no folder" in refused(capsys, "-o", blocked / "camera.yaml")
    assert "it is a folder" in refused(capsys, "--report", tmp_path)
    assert "skew" in refused(capsys, "--skew", "-o", tmp_path / "camera.yaml")
    assert "suffix" in refused(capsys, "-o", tmp_path / "camera.doc")
    assert sorted(tmp_path.iterdir()) == [blocked]
