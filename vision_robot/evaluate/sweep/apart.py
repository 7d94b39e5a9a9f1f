"""A process of its own for cells, so that a method which crashes or hangs is lost alone."""

import os
import pickle
import select
import signal
import struct
import subprocess
import sys
import tempfile
import threading
from concurrent.futures import CancelledError
from pathlib import Path
from time import monotonic, perf_counter
from typing import IO, Any, Self

from vision_robot.evaluate.sweep.cell import Cell, Outcome, measure
from vision_robot.machine.hardware import this_machine

__all__ = ["Apart", "measure_apart"]

LENGTH = struct.Struct(">Q")
SERVE = "from vision_robot.evaluate.sweep.apart import serve; serve()"

START_S = 300.0
"""In which a process has to be there; loading is not the cells' time."""

A_WHILE_S = 60.0
"""Longer waits than this are made in pieces."""

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "LP_NUM_THREADS")
"""What numerical libraries and the software renderer read when they start."""


class Apart:
    """Measures cells in one process after the other of its own; it is started at the first cell."""

    def __init__(self, patience_s: float, *, one_thread: bool = False):
        """`patience_s` is how long a cell may take; `one_thread` keeps each to one core."""
        self._patience_s, self._one_thread = patience_s, one_thread
        self._process: subprocess.Popen[bytes] | None = None
        self._said: IO[bytes] | None = None
        self._over = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._over = True
        self.close()

    def measure(self, cell: Cell, workspace: Path) -> Outcome:
        """The outcome; a failure with its reason where the process died or was ended for taking too long.

        Raises what `measure` raises, CancelledError after its end as a context.
        """
        if self._over:
            raise CancelledError
        start = perf_counter()
        process = self._running()
        assert process.stdin, "opened as a pipe"
        try:
            _send(process.stdin, (cell, workspace))
            answer = self._answer(process, self._patience_s)
        except TimeoutError:
            self.close()
            why = f"TimeLimit: it took longer than {self._patience_s:g} s and was ended"
        except (EOFError, BrokenPipeError):
            why = f"Crash: {self._last_words(process)}"
            self.close()
        else:
            if isinstance(answer, BaseException):
                raise answer
            return answer
        return Outcome(cell, {}, why, perf_counter() - start, 0, machine=this_machine())

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None
        if self._said is not None:
            self._said.close()
            self._said = None

    def _running(self) -> subprocess.Popen[bytes]:
        if self._process is None:
            environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
            if self._one_thread:
                environment |= dict.fromkeys(ONE_THREAD, "1")
            self._said = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the process
            # In a session of its own, where Ctrl-C does not reach: that is no failure of the method.
            self._process = subprocess.Popen(
                [sys.executable, "-c", SERVE],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._said,
                env=environment,
                start_new_session=True,
            )
            try:
                self._answer(self._process, START_S)
            except EOFError as error:
                raise ChildProcessError(self._last_words(self._process)) from error
        return self._process

    def _answer(self, process: subprocess.Popen[bytes], patience_s: float) -> Any:
        assert process.stdout, "opened as a pipe"
        until = monotonic() + patience_s
        (length,) = LENGTH.unpack(_received(process.stdout, LENGTH.size, until))
        return pickle.loads(_received(process.stdout, length, until))

    def _last_words(self, process: subprocess.Popen[bytes]) -> str:
        code = process.wait()
        how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
        assert self._said, "opened with the process"
        self._said.seek(0)
        lines = self._said.read().decode(errors="replace").strip().splitlines()
        return f"its process ended with {how}{f': {lines[-1]}' if lines else ''}"


def measure_apart(cell: Cell, workspace: Path, patience_s: float) -> Outcome:
    """As `Apart.measure`, with a process that each thread of a cluster's worker keeps."""
    kept: Apart | None = getattr(_KEPT, "apart", None)
    if kept is None:
        kept = _KEPT.apart = Apart(patience_s, one_thread=True)
    return kept.measure(cell, workspace)


_KEPT = threading.local()


def serve() -> None:
    """What the process does: measure the cells that come, until the other side is gone."""
    with os.fdopen(os.dup(0), "rb") as asked, os.fdopen(os.dup(1), "wb") as answers:
        # What a method reads is nothing, and what it prints goes to where errors go.
        nothing = os.open(os.devnull, os.O_RDONLY)
        os.dup2(nothing, 0)
        os.dup2(2, 1)
        if os.environ.get(ONE_THREAD[0]) == "1":
            import cv2

            cv2.setNumThreads(1)
        _send(answers, "ready")
        while header := asked.read(LENGTH.size):
            cell, workspace = pickle.loads(asked.read(*LENGTH.unpack(header)))
            answer: Any
            try:
                answer = measure(cell, workspace)
            except Exception as error:  # the other side raises it
                answer = error
            _send(answers, answer)


def _send(stream: IO[bytes], value: object) -> None:
    data = pickle.dumps(value)
    stream.write(LENGTH.pack(len(data)) + data)
    stream.flush()


def _received(stream: IO[bytes], length: int, until: float) -> bytes:
    """So many bytes. Raises TimeoutError when they are not there in time, EOFError when none will come."""
    parts, left = [], length
    while left:
        ready, _, _ = select.select([stream], [], [], min(max(0.0, until - monotonic()), A_WHILE_S))
        if not ready:
            if monotonic() < until:
                continue
            raise TimeoutError
        part = os.read(stream.fileno(), min(left, 1 << 20))
        if not part:
            raise EOFError
        parts.append(part)
        left -= len(part)
    return b"".join(parts)
