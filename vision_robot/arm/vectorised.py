"""CasADi functions over many points at once, as numpy: no compiler, no call per point.

CasADi's tape is written out as Python whose every line is one numpy operation on a row of a
work array, one row a register, one column a point. Points are taken in blocks that stay in cache.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from vision_robot.arm.tape import Tape, tape_of
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from casadi import Function

__all__ = ["Vectorised"]

CACHE_BYTES = 1 << 19
"""Work array of a block: half a second-level cache."""

BINARY = {
    "add": "add",
    "sub": "subtract",
    "mul": "multiply",
    "div": "divide",
    "fmin": "fmin",
    "fmax": "fmax",
    "atan2": "arctan2",
    "hypot": "hypot",
    "copysign": "copysign",
    "lt": "less",
    "le": "less_equal",
    "eq": "equal",
    "ne": "not_equal",
    "and": "multiply",  # of zeros and ones
    "or": "maximum",
}
UNARY = {
    "neg": "negative",
    "sqrt": "sqrt",
    "sin": "sin",
    "cos": "cos",
    "tan": "tan",
    "asin": "arcsin",
    "acos": "arccos",
    "atan": "arctan",
    "fabs": "absolute",
    "sign": "sign",
    "floor": "floor",
    "ceil": "ceil",
    "sq": "square",
    "inv": "reciprocal",
}
OTHERS = {
    "assign": "{0}",
    "twice": "{0} + {0}",
    "not": "{0} == 0",
    "if_else_zero": "np.where({0} != 0, {1}, 0.0)",  # no product: what is not chosen may be no number
}


class Vectorised:
    """An SX function as a numpy function of arrays (numbers, points): one column a point."""

    def __init__(self, function: "Function"):
        self.tape = tape_of(function)
        self.block = max(256, CACHE_BYTES // (8 * max(self.tape.registers, 1)))
        self._run = _compiled(self.tape)

    def __call__(self, *arguments: Float[Array, "_ points"]) -> tuple[Float[Array, "_ points"], ...]:
        """Each output as (numbers, points)."""
        points = arguments[0].shape[1]
        results = tuple(np.zeros((count, points)) for _, count in self.tape.outputs)
        work = np.empty((self.tape.registers, min(self.block, points)))
        with np.errstate(all="ignore"):
            for start in range(0, points, self.block):
                part = slice(start, min(start + self.block, points))
                rows = work[:, : part.stop - start]
                self._run(rows, [a[:, part] for a in arguments], [r[:, part] for r in results])
        return results


def _compiled(tape: Tape) -> Callable[[Array, Sequence[Array], Sequence[Array]], None]:
    """The tape as one Python function of (work, inputs, outputs)."""
    lines = [f"w{k} = work[{k}]" for k in range(tape.registers)]
    where: dict[int, str] = {}
    """What holds each register's value: its row, a row of an input, or a number."""
    for instruction in tape.instructions:
        target, at = instruction.target, instruction.at
        if instruction.op == "const":
            where[target] = repr(instruction.constant)
        elif instruction.op == "input":
            where[target] = f"inputs[{at[0]}][{at[1]}]"
        elif instruction.op == "output":
            lines.append(f"outputs[{at[0]}][{at[1]}] = {where[instruction.sources[0]]}")
        else:
            lines.append(_line(instruction.op, [where[k] for k in instruction.sources], f"w{target}"))
            where[target] = f"w{target}"
    text = f"def {tape.name}(work, inputs, outputs):\n    " + "\n    ".join(lines)
    scope: dict[str, object] = {"np": np}
    exec(compile(text, f"<{tape.name}>", "exec"), scope)
    return scope[tape.name]  # type: ignore[return-value]


def _line(op: str, sources: list[str], out: str) -> str:
    """One operation as a line of numpy."""
    if op in BINARY:
        return f"np.{BINARY[op]}({sources[0]}, {sources[1]}, out={out})"
    if op in UNARY:
        return f"np.{UNARY[op]}({sources[0]}, out={out})"
    if op in OTHERS:
        return f"{out}[...] = {OTHERS[op].format(*sources)}"
    raise NotImplementedError(f"numpy form of CasADi's operation {op!r}")
