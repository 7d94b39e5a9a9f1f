"""How fast memory is, and how much of it a process holds."""

import gc
import resource
import sys
from functools import cache
from pathlib import Path
from time import perf_counter

import numpy as np

__all__ = ["PeakMemory", "read_bandwidth"]

BYTES, REPEATS = 1 << 26, 7
"""More than caches hold."""

STATUS, CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")


@cache
def read_bandwidth() -> float:
    """Bytes a second that one core reads from memory: the best of some sums over 64 MiB."""
    words = np.ones(BYTES // 8, dtype=np.uint64)
    taken = []
    for _ in range(REPEATS):
        start = perf_counter()
        words.sum()
        taken.append(perf_counter() - start)
    return BYTES / min(taken)


class PeakMemory:
    """Largest memory that a stretch of work held, beyond what the process held before.

    Linux can forget an earlier peak; elsewhere an earlier and higher peak of the process hides what follows,
    and the figure is too small.
    """

    def __init__(self) -> None:
        gc.collect()
        try:
            CLEAR.write_text("5", encoding="ascii")
            self._before, self._exact = _status("VmRSS:"), True
        except OSError:
            self._before, self._exact = _largest(), False

    def bytes(self) -> int:
        """So far."""
        return max(0, (_status("VmHWM:") if self._exact else _largest()) - self._before)


def _status(name: str) -> int:
    line = next(line for line in STATUS.read_text(encoding="ascii").splitlines() if line.startswith(name))
    return 1024 * int(line.split()[1])


def _largest() -> int:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else 1024 * peak
