"""Work for the tests of sweeps: what a cell may do, well or badly."""

import errno
import os
import signal
import time
from pathlib import Path


def count(
    workspace: Path, folder: str, value: float, *, sleep_s: float = 0.0, fail: bool = False, end: str = ""
) -> dict[str, float]:
    """Leave a trace of every call, then answer; or print, and end the process or fill the disk."""
    trace = Path(folder) / f"{value}.{os.getpid()}.{time.monotonic_ns()}"
    trace.touch()
    time.sleep(sleep_s)
    if fail:
        raise ValueError(f"no answer for {value}")
    print(f"{value} is talkative")
    if end == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
    elif end == "left":
        os.write(2, b"some warning\nthe last word\n")
        os._exit(7)
    elif end == "full":
        raise OSError(errno.ENOSPC, "No space left on device")
    return {"metric": 2 * value, "never": float("nan")}


def calls(folder: Path, value: float) -> int:
    """How often `count` was called with this value."""
    return len(list(Path(folder).glob(f"{value}.*")))
