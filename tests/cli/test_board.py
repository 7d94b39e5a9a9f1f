"""`vr board` writes what was asked for, to scale, and refuses the impossible in one line."""

import json
import re

import pytest
import typer
from typer.testing import CliRunner

from vision_robot.errors import BadParameter, UnwritableOutput
from vision_robot_cli.board import board

app = typer.Typer()
app.command("board")(board)


def run(*words: object):
    return CliRunner().invoke(app, [str(word) for word in words])


def test_default_is_an_a4_pdf(tmp_path):
    """9x6 corners of 25 mm fit an A4 sheet on its side."""
    out = tmp_path / "board.pdf"
    result = run("--out", out)
    assert result.exit_code == 0
    assert out.read_bytes().startswith(b"%PDF")
    assert result.stdout == (
        f"{out}: chessboard 9x6 inner corners, squares 25 mm, on a4 297 x 210 mm; print at 100 %\n"
    )


def test_json_is_one_object(tmp_path):
    """Everything a script needs to know, in millimetres."""
    out = tmp_path / "board.svg"
    result = run("--size", "5x4", "--square", "3cm", "-o", out, "--json")
    assert json.loads(result.stdout) == {
        "schema": "vr.board/1",
        "board": "chessboard",
        "size": "5x4",
        "description": "chessboard 5x4 inner corners, squares 30 mm",
        "points": 20,
        "page": "none",
        "page_mm": [240, 210],
        "target_mm": [240, 210],
        "out": str(out),
    }
    assert out.read_text().startswith("<svg")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--square", "0mm"], "positive length"),
        (["--square", "-5mm"], "positive length"),
        (["--square", "25"], "with its unit"),
        (["--size", "9by6"], "9x6"),
        (["--size", "0x6"], "9x6"),
        (["--size", "2x2"], "inner corners"),
        (["--board", "checkers"], "chessboard"),
        (["--square", "60mm", "--page", "a4"], "at least a1"),
        (["--square", "60mm", "--page", "b5"], "letter"),
        (["-o", "board.docx"], r"\*\.pdf"),
        (["--dpi", "0", "-o", "board.png"], "dpi"),
    ],
)
def test_bad_input_is_refused_and_nothing_is_written(words, message, tmp_path, monkeypatch):
    """Each cause by its own name; the launcher turns it into exit code 2."""
    monkeypatch.chdir(tmp_path)
    result = run(*words)
    assert isinstance(result.exception, BadParameter)
    assert re.search(message, str(result.exception))
    assert not list(tmp_path.iterdir())


def test_unwritable_place(tmp_path):
    """A folder where the file should go."""
    (tmp_path / "board.svg").mkdir()
    assert isinstance(run("-o", tmp_path / "board.svg").exception, UnwritableOutput)
