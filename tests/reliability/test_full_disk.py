"""Rows that found no place on the disk do not pass for a whole table."""

import resource
import signal
import subprocess
import sys

import pytest

SCRIPT = """
import sys
import numpy as np
from vision_robot.errors import UnwritableOutput
from vision_robot.track.row_writers import row_writer
from vision_robot.tracks import Tracks
n, pairs = np.arange(100), np.ones((100, 2))
table = Tracks(n, n / 25, n, pairs, np.ones((100, 4)), n * 1.0, pairs, n * 1.0, pairs, pairs)
try:
    with row_writer(sys.argv[1]) as rows:
        for _ in range(int(sys.argv[2])):
            rows.write(table)
except (UnwritableOutput, OSError) as error:
    print(type(error).__name__, error)
"""


def small_files_only() -> None:
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (900, 900))


@pytest.mark.parametrize("suffix", [".csv", ".json", ".txt"])
@pytest.mark.parametrize("times", [1, 20])
def test_rows_are_whole_or_not_there(tmp_path, suffix, times):
    words = [sys.executable, "-c", SCRIPT, str(tmp_path / f"rows{suffix}"), str(times)]
    done = subprocess.run(words, capture_output=True, text=True, check=True, preexec_fn=small_files_only)
    assert done.stdout.startswith("UnwritableOutput")
    assert "File too large" in done.stdout
    assert not list(tmp_path.iterdir())
