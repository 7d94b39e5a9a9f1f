"""Ctrl-C ends a command with its workers, in one line, and what is made is kept."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path


def end_by_interrupt(words: list[str], when) -> tuple[int, str]:
    """Code and stderr of a command that is interrupted, with all it started, when `when()` is true."""
    run = subprocess.Popen(
        [sys.executable, "-m", "vision_robot_cli", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509
    )
    until = time.monotonic() + 120
    while not when() and time.monotonic() < until:
        assert run.poll() is None, "it was done before it could be interrupted"
        time.sleep(0.01)
    os.killpg(run.pid, signal.SIGINT)
    _, err = run.communicate(timeout=60)
    assert nobody_left(run.pid)
    # Python itself ends by the signal where it was making a class just then; to a shell both are 130.
    return 130 if run.returncode == -signal.SIGINT else run.returncode, err


def nobody_left(session: int) -> bool:
    """Whether its session dies out soon."""
    until = time.monotonic() + 30
    while time.monotonic() < until:
        try:
            os.killpg(session, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.05)
    return False


def notes(folder: Path) -> list[Path]:
    return list(folder.glob(".set.*.notes/[0-9]*"))


def test_workers_end_at_once(tmp_path):
    words = [
        "synth",
        "crowd",
        "--frames",
        "200",
        "--size",
        "96x72",
        "--workers",
        "2",
        "-o",
        str(tmp_path / "set"),
    ]
    code, err = end_by_interrupt(words, lambda: len(notes(tmp_path)) >= 2)
    assert (code, err) == (130, "vr: interrupted\n")
    assert 2 <= len(notes(tmp_path)) < 60  # a stretch of frames handed out is not finished first
    assert not (tmp_path / "set").exists()


def test_an_interrupt_while_it_starts_has_its_line():
    start = time.monotonic()
    code, err = end_by_interrupt(["calibrate"], lambda: time.monotonic() > start + 0.5)
    assert (code, err) in ((130, "vr: interrupted\n"), (130, ""))
