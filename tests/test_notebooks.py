"""Every notebook runs from a clean kernel, and its two halves say the same.

A notebook is a .py file (jupytext, py:percent) and an .ipynb with its outputs. After a change to the
first, ``WRITE_NOTEBOOKS=1 pytest tests/test_notebooks.py`` writes the second.
"""

import os
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "notebooks"
SCRIPTS = sorted(FOLDER.glob("*.py"))
SECONDS = 60

# The kernel and its client talk over sockets which the garbage collector may close late.
pytestmark = pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_runs_from_a_clean_kernel(script):
    import jupytext
    from nbclient import NotebookClient

    notebook = jupytext.read(script)
    client = NotebookClient(
        notebook, timeout=SECONDS, kernel_name="python3", resources={"metadata": {"path": str(FOLDER)}}
    )
    client.execute()
    if os.environ.get("WRITE_NOTEBOOKS"):
        for cell in notebook.cells:
            cell.metadata.pop("execution", None)
        jupytext.write(notebook, script.with_suffix(".ipynb"))


def test_there_are_notebooks_and_each_has_both_halves():
    assert SCRIPTS
    assert [path.stem for path in SCRIPTS] == sorted(path.stem for path in FOLDER.glob("*.ipynb"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_halves_are_in_step(script):
    import jupytext

    said = [(cell.cell_type, cell.source) for cell in jupytext.read(script).cells]
    kept = jupytext.read(script.with_suffix(".ipynb"))
    assert [(cell.cell_type, cell.source) for cell in kept.cells] == said, "write it as above"
    code = [cell for cell in kept.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1)), "not run in one go"
    outputs = [output for cell in code for output in cell.outputs]
    assert any("image/png" in output.get("data", {}) for output in outputs), "no figure in it"
    assert not any(output.output_type == "error" or output.get("name") == "stderr" for output in outputs)
