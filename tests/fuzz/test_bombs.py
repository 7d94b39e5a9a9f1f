"""Small files that ask for much, lead elsewhere or would run something are refused soon, in little memory."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.fuzz.bombs import BOMBS, LIMIT_MB

READ = {
    "CSV of 5 million empty lines",  # a table without rows
    "video that claims 2 500 megapixels",  # FFmpeg goes by the frames themselves
}
"""What is harmless to read, or was found to be."""


@pytest.fixture(scope="module")
def answers():
    command = [sys.executable, "-m", "tests.fuzz.bombs"]
    ended = subprocess.run(command, capture_output=True, text=True, cwd=Path(__file__).parents[2], check=True)
    return json.loads(ended.stdout)


@pytest.mark.parametrize("bomb", BOMBS)
def test_it_does_no_harm(answers, bomb):
    end, _, megabytes = answers[bomb]
    assert end in ({"read", "refused"} if bomb in READ else {"refused"})
    assert megabytes < LIMIT_MB / 2
