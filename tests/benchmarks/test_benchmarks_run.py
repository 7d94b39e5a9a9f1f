"""Each benchmark script runs to its end with --quick and prints a table or one JSON object."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", ["coverage", "hand_eye", "next_view", "refinement"])
@pytest.mark.parametrize("name", ["coverage", "measure", "next_view", "refinement", "triangulation"])
@pytest.mark.parametrize("name", ["coverage", "next_view", "refinement", "truth_accuracy", "truth_speed"])
@pytest.mark.parametrize("name", ["coverage", "next_view", "refinement", "ik_export"])
@pytest.mark.parametrize(
    "name", ["coverage", "next_view", "refinement", "synth_speed", "truth_accuracy", "truth_speed"]
)
def test_it_runs(name):
    script = ROOT / "benchmarks" / f"{name}.py"
    done = subprocess.run(
        [sys.executable, str(script), "--quick", "--json"],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    assert answer["schema"] == f"vr.benchmark.{name}/1"
    assert answer["figures"]
