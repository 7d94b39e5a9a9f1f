"""`vr benchmark flow --data` as a person runs it: a page, tables for a paper, bad input."""

import csv
import json

import pytest

from tests.synth.suites.test_flow import sequence
from vision_robot_cli.main import run

TWO = ["--method", "vr-fast", "--method", "no-motion"]


def test_own_sequences_give_scores_a_page_and_tables(capsys, tmp_path):
    for k, name in enumerate(("Grove", "Urban")):
        sequence(tmp_path / "data" / "other-data" / name, seed=k)
    where = ["-o", str(tmp_path / "results"), "--report", str(tmp_path / "flow.html")]
    tables = tmp_path / "tables"
    data = ["--data", str(tmp_path / "data"), "--tables", str(tables)]
    code = run(["benchmark", "flow", *data, *TWO, *where, "--json"])
    found = json.loads(capsys.readouterr().out)
    assert code == 0
    assert found["failures"] == []
    scores = {(s["scene"], s["method"]): s for s in found["scores"] if s["metric"] == "flow_epe_px"}
    scenes, methods = ("other-data/Grove", "other-data/Urban"), ("vr-fast", "no-motion")
    assert set(scores) == {(scene, method) for scene in scenes for method in methods}
    assert all(one["n"] == 1 and one["low"] is None for one in scores.values())
    assert "No method is better in flow_epe_px than every other over 2 scenes" in found["conclusions"][0]
    (pair,) = found["comparisons"]
    assert (pair["better"], pair["verdict"], pair["seeds"]) == ("vr-fast", "open", 2)
    page = (tmp_path / "flow.html").read_text()
    assert "No method is better in flow_epe_px than every other over 2 scenes" in page
    assert json.loads((tables / "scores.json").read_text()) == found
    rows = list(csv.DictReader((tables / "scores.csv").read_text().splitlines()))
    assert len(rows) == len(found["scores"])
    assert (tables / "summary-flow.csv").read_text().startswith("method,flow_epe_px,to vr-fast,")
    assert r"\toprule" in (tables / "summary-flow.tex").read_text()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["flow", "--data", "none"], "there is no such folder"),
        (["ik", "--data", "."], "makes its own data"),
        (["all", "--data", "."], "where --data is given"),
        (["flow", "--method", "raft"], "cv2-dis-medium"),
        (["ik", "--scene", "nao"], "puma-560"),
    ],
)
def test_bad_input_is_one_line(capsys, tmp_path, arguments, says):
    assert run(["benchmark", *arguments, "-o", str(tmp_path / "out")]) == 2
    captured = capsys.readouterr()
    assert says in captured.err
    assert len(captured.err.strip().splitlines()) == 1
