"""An arm's functions over many goals in C, made of CasADi's tapes and compiled once."""

import ctypes
from importlib.resources import files
from pathlib import Path

import numpy as np

from vision_robot.arm.build import load_library
from vision_robot.arm.engine import CLOSE, Engine, Program, Rows
from vision_robot.arm.lane_code import lane_code
from vision_robot.arm.numpy_engine import SLACK
from vision_robot.types import Array, Float, Int

__all__ = ["CompiledEngine", "compiled_engine", "source_of"]


def compiled_engine(program: Program, folder: Path | None = None) -> "CompiledEngine | None":
    """The engine in C; None where no compiler can make it. `folder` stands for the user's cache."""
    library = load_library(source_of(program), folder)
    return CompiledEngine(program, library) if library is not None else None


def source_of(program: Program) -> str:
    """The whole C source."""
    native = files("vision_robot.arm") / "native"
    parts = [f"#define JOINTS {len(program.chain)}"]
    if program.closed:
        parts.append(f"#define BRANCHES {program.closed.branches}")
    parts += [
        (native / "lanes.h").read_text(encoding="utf-8"),
        lane_code(program.step),
        lane_code(program.patient_step),
        lane_code(program.error),
    ]
    if program.closed:
        parts.append(lane_code(program.closed.function))
    parts.append((native / "driver.c").read_text(encoding="utf-8"))
    return "\n".join(parts)


class CompiledEngine(Engine):
    """Runs where a C compiler is; lets other threads run meanwhile."""

    name = "compiled"

    def __init__(self, program: Program, library: ctypes.CDLL):
        self.program, self._library = program, library
        starts = program.starts
        self._features = np.ascontiguousarray((starts.pose * starts.weights).T, dtype=np.float32)
        self._squares = np.sum(self._features.astype(float) ** 2, axis=0).astype(np.float32)

    def numeric(
        self,
        goals: Rows,
        *,
        first: Float[Array, "goals n"] | None,
        tries: int,
        iterations: int,
        patient: bool = False,
    ) -> Float[Array, "goals n"]:
        """See `Engine.numeric`."""
        starts = self.program.starts
        q = np.empty((len(goals), len(self.program.chain)))
        used = np.empty(len(goals), dtype=np.int32)
        self._library.solve_numeric(
            ctypes.c_long(len(goals)),
            _of(goals),
            None if first is None else _of(first),
            ctypes.c_int(len(starts.q)),
            _of(starts.q),
            _of(self._features, np.float32),
            _of(self._squares, np.float32),
            _of(starts.weights),
            ctypes.c_int(min(tries, len(starts.q))),
            ctypes.c_int(iterations),
            ctypes.c_int(patient),
            _of(np.array(CLOSE)),
            ctypes.c_double(self.program.scale),
            _of(q),
            _of(used, np.int32),
        )
        return q

    def errors(self, goals: Rows, q: Float[Array, "goals n"]) -> Float[Array, "goals 2"]:
        """See `Engine.errors`."""
        errors = np.empty((len(goals), 2))
        self._library.measure(ctypes.c_long(len(goals)), _of(goals), _of(q), _of(errors))
        return errors

    def closed(
        self, goals: Rows
    ) -> tuple[Float[Array, "goals branches n"], Float[Array, "goals branches 2"]]:
        """See `Engine.closed`."""
        assert self.program.closed is not None
        branches = self.program.closed.branches
        q = np.empty((len(goals), branches, len(self.program.chain)))
        errors = np.empty((len(goals), branches, 2))
        self._library.solve_closed(ctypes.c_long(len(goals)), _of(goals), _of(q), _of(errors))
        return q, errors

    def choose(
        self,
        goals: Rows,
        *,
        near: Float[Array, "rows n"],
        weights: Float[Array, "n"],
        periods: Float[Array, "n"],
        tolerance: tuple[float, float],
    ) -> tuple[Float[Array, "goals n"], Float[Array, "goals 2"], Int[Array, "goals"]]:
        """See `Engine.choose`."""
        n = len(self.program.chain)
        q, errors = np.empty((len(goals), n)), np.empty((len(goals), 2))
        branch = np.empty(len(goals), dtype=np.int32)
        self._library.choose_closed(
            ctypes.c_long(len(goals)),
            _of(goals),
            _of(self.program.chain.limits),
            _of(near),
            ctypes.c_long(0 if len(near) == 1 else n),
            _of(weights),
            _of(periods),
            _of(np.array(tolerance)),
            ctypes.c_double(SLACK),
            ctypes.c_double(self.program.scale),
            _of(q),
            _of(errors),
            _of(branch, np.int32),
        )
        return q, errors, branch.astype(int)


class _Held(ctypes.c_void_p):
    """The address of an array, which it keeps alive during the call."""

    array: Array


def _of(array: Array, kind: type = np.float64) -> _Held:
    ready = np.ascontiguousarray(array, dtype=kind)
    held = _Held(ready.ctypes.data)
    held.array = ready
    return held
