"""Doing something in a process whose memory and time are limited."""

import multiprocessing
import resource
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from time import perf_counter

__all__ = ["apart", "limit_memory", "resident_mb"]


def apart(work: Callable[[], str], megabytes: float, seconds: float) -> tuple[str, float, float]:
    """What `work` answers in a forked process, how long it took [s] and how much more memory [MB].

    "more than SECONDS s" and "the process ended with CODE" are answers too.
    """
    context = multiprocessing.get_context("fork")
    here, there = context.Pipe(duplex=False)
    child = context.Process(target=_answer, args=(work, megabytes, there))
    start = perf_counter()
    child.start()
    there.close()
    try:
        if not here.poll(seconds):
            return f"more than {seconds:g} s", seconds, 0.0
        return here.recv()
    except EOFError:
        child.join()
        return f"the process ended with {child.exitcode}", perf_counter() - start, 0.0
    finally:
        child.kill()
        child.join()


def _answer(work: Callable[[], str], megabytes: float, there: Connection) -> None:
    before, start = resident_mb(), perf_counter()
    limit_memory(megabytes)
    end = work()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    there.send((end, perf_counter() - start, max(peak - before, 0.0)))


def limit_memory(megabytes: float) -> None:
    """So much more address space than now; no core files."""
    most = int(_pages(0) * resource.getpagesize() + megabytes * 1e6)
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def resident_mb() -> float:
    """Memory that the process holds now [MB]."""
    return _pages(1) * resource.getpagesize() / 1e6


def _pages(column: int) -> int:
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[column])
