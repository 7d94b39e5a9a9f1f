"""The command alone speaks on stderr, in one line; outputs that nobody takes end it in words."""

import subprocess
import sys

import cv2
import numpy as np
import pytest

VR = [sys.executable, "-m", "vision_robot_cli"]


def ended(line: str, *words: str) -> subprocess.CompletedProcess[str]:
    """In a shell, as "$@"."""
    return subprocess.run(
        ["bash", "-c", line, "bash", *VR, *words], capture_output=True, text=True, check=False, timeout=120
    )


def test_decoders_are_not_heard(tmp_path):
    data = bytearray(cv2.imencode(".png", np.zeros((64, 64), np.uint8))[1].tobytes())
    data[60] ^= 255  # libpng itself would print "libpng error: IDAT: CRC error"
    (tmp_path / "a.png").write_bytes(data)
    said = ended('"$@"', "calibrate", str(tmp_path), "--json")
    assert said.returncode == 2
    assert said.stdout == ""
    assert said.stderr.count("\n") == 1
    assert said.stderr.startswith("vr: error: ")


@pytest.mark.parametrize("line", ['"$@" > /dev/full', 'ulimit -f 0; "$@" > "$(mktemp)"'])
def test_a_full_place_for_stdout_is_said(line):
    said = ended(line, "synth", "--list", "--json")
    assert said.returncode == 1
    assert said.stderr in ("vr: error: No space left on device\n", "vr: error: File too large\n")


@pytest.mark.parametrize("line", ['"$@" >&-', '"$@" 2>&-', '"$@" <&-', '"$@" >&- 2>&- <&-'])
def test_closed_streams_do_not_matter(line):
    said = ended(line, "--version")
    assert said.returncode == 0
    assert said.stderr == ""


def test_an_error_without_stderr_does_not_go_to_stdout():
    said = ended('"$@" 2>&-', "bogus")
    assert said.returncode == 2
    assert said.stdout == ""


def test_a_name_that_is_no_text_can_be_shown(tmp_path):
    said = ended('cd "$(mktemp -d)" && "$@" "$(printf "caf\\xe9.json")"', "convert", "-o", "x.yaml")
    assert said.returncode == 2
    assert "caf" in said.stderr
    assert said.stderr.count("\n") == 1
