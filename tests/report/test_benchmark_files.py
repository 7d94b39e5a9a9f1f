"""Tables for papers and programs: every digit, and nothing that LaTeX or CSV would trip over."""

import csv
import io
import re
import shutil
import subprocess

import pytest

from tests.evaluate.made_outcomes import outcomes
from vision_robot.evaluate.answer import answer
from vision_robot.evaluate.score import scores
from vision_robot.report.benchmark_answer import summary_table
from vision_robot.report.benchmark_files import escaped, scores_csv, table_csv, table_latex

MADE = outcomes({"rgb_plain": [0.9, 0.8, 0.85], "100%, & more": [0.1, 0.2, 0.3]}, scene="noise=0.5")


def table():
    found = answer(MADE, "success_auc")
    assert found is not None
    return summary_table(MADE, found)


def test_scores_read_back_to_the_last_digit():
    rows = list(csv.DictReader(io.StringIO(scores_csv(scores(MADE)))))
    assert [row["method"] for row in rows] == ["rgb_plain", "100%, & more"]
    assert [float(row["value"]) for row in rows] == [score.value for score in scores(MADE)]
    (one,) = csv.DictReader(io.StringIO(scores_csv(scores(MADE[:1]))))
    assert (one["low"], one["high"]) == ("", "")  # one seed has no interval


def test_the_summary_is_the_table_of_the_page():
    rows = list(csv.reader(io.StringIO(table_csv(table()))))
    assert tuple(rows[0]) == table().columns
    assert [tuple(row) for row in rows[1:]] == list(table().rows)


def test_latex_has_one_row_a_method_and_no_bare_letter():
    text = table_latex(table(), label="tab:trackers")
    rows = [line for line in text.splitlines() if line.endswith(r"\\")]
    assert len(rows) == 3
    counts = {len(re.findall(r"(?<!\\)&", row)) for row in rows}
    assert counts == {len(table().columns) - 1}
    body = text[text.index(r"\toprule") : text.index(r"\bottomrule")]
    assert not re.search(r"(?<!\\)[_%#]", body)
    assert text.isascii()


@pytest.mark.parametrize(
    ("text", "set_as"),
    [("a_b", r"a\_b"), ("50 %", r"50 \%"), (r"\x{1}", r"\textbackslash{}x\{1\}"), ("−3 – 4", "$-$3 -- 4")],
)
def test_what_latex_would_take_for_something_else(text, set_as):
    assert escaped(text) == set_as


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no LaTeX on this machine")
def test_latex_sets_it(tmp_path):
    body = table_latex(table(), label="tab:a")
    (tmp_path / "a.tex").write_text(
        r"\documentclass{article}\usepackage{booktabs}\begin{document}" + body + r"\end{document}"
    )
    subprocess.run(["pdflatex", "-halt-on-error", "a.tex"], cwd=tmp_path, check=True, capture_output=True)
