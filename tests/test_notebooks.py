"""Every notebook runs from a clean kernel, its two halves say the same, and it is fit to be kept.

A notebook is a .py file (jupytext, py:percent) and an .ipynb with its outputs. After a change to the
first, ``WRITE_NOTEBOOKS=1 pytest tests/test_notebooks.py`` writes the second.
"""

import base64
import io
import json
import os
import re
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "notebooks"
SCRIPTS = sorted(FOLDER.glob("*.py"))
SECONDS = 600
"""For one cell on a machine that has other work; alone every notebook takes less than two minutes."""

MOST_BYTES = 400_000
PLOT_BYTES = 60_000
PICTURES = {"image/png", "image/jpeg"}

MACHINE_PATH = re.compile(
    r"(?<![\w.:/-])/(?:home|root|tmp|usr|work|var|opt|mnt|Users)/|[A-Z]:\\\\|site-packages"
)
"""What a path of the machine that wrote the outputs looks like."""

each = pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)

# The kernel and its client talk over sockets which the garbage collector may close late.
pytestmark = pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)


@each
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
        notebook.metadata.pop("language_info", None)  # names the version of Python that happened to run it
        _make_pictures_small(notebook)
        jupytext.write(notebook, script.with_suffix(".ipynb"))


def test_there_are_notebooks_and_each_has_both_halves_and_a_line_in_the_index():
    assert len(SCRIPTS) >= 10
    assert [path.stem for path in SCRIPTS] == sorted(path.stem for path in FOLDER.glob("*.ipynb"))
    index = (FOLDER / "README.md").read_text()
    assert sorted(re.findall(r"\]\((\w+)\.ipynb\)", index)) == [path.stem for path in SCRIPTS]


@each
def test_halves_are_in_step(script):
    import jupytext

    said = [(cell.cell_type, cell.source) for cell in jupytext.read(script).cells]
    kept = jupytext.read(script.with_suffix(".ipynb"))
    assert [(cell.cell_type, cell.source) for cell in kept.cells] == said, "write it as above"
    written = jupytext.writes(kept, fmt="py:percent")
    assert _below_the_header(written) == _below_the_header(script.read_text(encoding="utf-8"))
    code = [cell for cell in kept.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1)), "not run in one go"
    outputs = [output for cell in code for output in cell.outputs]
    assert any(PICTURES & set(output.get("data", {})) for output in outputs), "no figure in it"
    assert not any(output.output_type == "error" or output.get("name") == "stderr" for output in outputs)


@each
def test_is_fit_to_be_kept(script):
    kept = script.with_suffix(".ipynb")
    assert kept.stat().st_size < MOST_BYTES
    notebook = json.loads(kept.read_text(encoding="utf-8"))
    assert set(notebook["metadata"]) == {"jupytext", "kernelspec"}
    for cell in notebook["cells"]:
        assert set(cell["metadata"]) <= {"lines_to_next_cell"}  # which the .py half needs
        for output in cell.get("outputs", []):
            told = {kind: data for kind, data in output.get("data", {}).items() if kind not in PICTURES}
            text = json.dumps({**output, "data": told})
            assert not MACHINE_PATH.search(text), text
    assert any("assert " in "".join(cell["source"]) for cell in notebook["cells"]), "its prose is not checked"


def _below_the_header(text):
    """The cells: the header tells jupytext's version besides."""
    return text[text.index("\n# %%") :]


def _make_pictures_small(notebook):
    """Photos as JPEG: a fifth of the size. Plots are small, and stay sharp, as they are."""
    from PIL import Image

    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            picture = base64.b64decode(output.get("data", {}).get("image/png", ""))
            if len(picture) > PLOT_BYTES:
                small = io.BytesIO()
                colours = Image.open(io.BytesIO(picture)).convert("RGB")
                colours.save(small, "jpeg", quality=90, subsampling=0, optimize=True)
                del output["data"]["image/png"]
                output["data"]["image/jpeg"] = base64.b64encode(small.getvalue()).decode() + "\n"
