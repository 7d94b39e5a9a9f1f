"""Each benchmark script runs to its end with --quick and prints a table or one JSON object."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


QUICK = [
    "adversity",
    "coverage",
    "fuzz",
    "hand_eye",
    "ik",
    "ik_export",
    "kill",
    "measure",
    "next_view",
    "refinement",
    "servoing",
    "synth_speed",
    "trackers",
    "triangulation",
    "truth_accuracy",
    "truth_speed",
    "untilted",
]


@pytest.mark.parametrize("name", QUICK)
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
