"""Work for the tests of sweeps: what a cell may do, well or badly."""

import os
import time
from pathlib import Path


def count(folder: str, value: float, *, sleep_s: float = 0.0, fail: bool = False) -> dict[str, float]:
    """Leave a trace of every call, then answer."""
    trace = Path(folder) / f"{value}.{os.getpid()}.{time.monotonic_ns()}"
    trace.touch()
    time.sleep(sleep_s)
    if fail:
        raise ValueError(f"no answer for {value}")
    return {"metric": 2 * value, "never": float("nan")}


def calls(folder: Path, value: float) -> int:
    """How often `count` was called with this value."""
    return len(list(Path(folder).glob(f"{value}.*")))
