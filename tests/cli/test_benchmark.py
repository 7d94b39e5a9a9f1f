"""`vr benchmark` as a person runs it: scores, a page, resumption, an older run as the bar, bad input."""

import json

import pytest

from vision_robot_cli.main import run

QUICK = ["--scene", "views=4", "--method", "vr", "--method", "cv2", "--seeds", "2"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("benchmark")


def benchmark(capsys, folder, *arguments) -> tuple[int, dict, str]:
    code = run(["benchmark", "calibration", *QUICK, "-o", str(folder), "--json", *map(str, arguments)])
    captured = capsys.readouterr()
    return code, json.loads(captured.out), captured.err


def test_scores_with_intervals_and_a_page(capsys, folder):
    code, found, _ = benchmark(capsys, folder, "--report", folder / "page.html")
    assert code == 0
    assert found["schema"] == "vr.benchmark/1"
    scores = {(one["method"], one["metric"]): one for one in found["scores"]}
    corner = scores["vr", "corner_error_px"]
    assert corner["value"] < scores["cv2", "corner_error_px"]["value"]
    assert set(corner) >= {"suite", "scene", "low", "high", "unit", "better", "n"}
    assert corner["n"] == 2
    assert found["failures"] == []
    assert "Benchmark: calibration" in (folder / "page.html").read_text()


def test_what_is_known_is_not_measured_again(capsys, folder):
    _, first, _ = benchmark(capsys, folder)
    _, again, err = benchmark(capsys, folder)
    assert "4 of 4 cells are known already" in err
    assert again == first


def test_worse_than_an_older_run_beyond_noise_ends_with_3(capsys, folder):
    _, found, _ = benchmark(capsys, folder)
    for score in found["scores"]:
        if (score["method"], score["metric"]) == ("vr", "boards_found"):
            score.update(value=2.0, low=2.0, high=2.0)  # better than anything can be
    older = folder / "older.json"
    older.write_text(json.dumps(found))
    code = run(["benchmark", "calibration", *QUICK, "-o", str(folder), "--baseline", str(older)])
    assert code == 3
    assert "worse: calibration, views=4, vr: boards_found 2 -> 1" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["nonsense"], "calibration"),
        (["calibration", "--scene", "rain"], "usual"),
        (["calibration", "--method", "yolo"], "cv2-sb"),
        (["all", "--method", "vr"], "--scene or --method"),
        (["calibration", "--seeds", "0"], "seeds"),
        (["calibration", "--workers", "0", *QUICK], "workers"),
        (["calibration", "--baseline", "none.json"], "none.json"),
        (["calibration", "--scheduler", "tcp://127.0.0.1:9", *QUICK], "127.0.0.1:9"),
    ],
)
def test_bad_input_is_one_line(capsys, tmp_path, arguments, says):
    assert run(["benchmark", *arguments, "-o", str(tmp_path / "out")]) == 2
    captured = capsys.readouterr()
    assert says in captured.err
    assert len(captured.err.strip().splitlines()) == 1
    assert captured.out == ""
