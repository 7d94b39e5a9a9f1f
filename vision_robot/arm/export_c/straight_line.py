"""A CasADi expression as one straight-line C function, without CasADi's run time or work arrays."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from vision_robot.arm.export_c.precision import Precision
from vision_robot.arm.tape import Tape, tape_of
from vision_robot.errors import BadParameter

if TYPE_CHECKING:
    import casadi

__all__ = ["StraightLine", "straight_line"]

INFIX = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
COMPARISONS = {"lt": "<", "le": "<=", "eq": "==", "ne": "!="}
FUNCTIONS = {name: name for name in (
    "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp", "log", "fabs", "floor", "ceil",
    "fmod", "fmin", "fmax", "copysign", "pow", "hypot",
)} | {"constpow": "pow"}  # fmt: skip
OTHERS = {
    "assign": "{0}",
    "neg": "-({0})",
    "sq": "{0} * {0}",
    "twice": "{0} + {0}",
    "inv": "{one} / {0}",
    "not": "{0} == {zero} ? {one} : {zero}",
    "and": "{0} != {zero} && {1} != {zero} ? {one} : {zero}",
    "or": "{0} != {zero} || {1} != {zero} ? {one} : {zero}",
    "if_else_zero": "{0} != {zero} ? {1} : {zero}",
    "sign": "{0} > {zero} ? {one} : {0} < {zero} ? -{one} : {0}",
}
COUNTED_AS = {"sub": "add", "sq": "mul", "inv": "div", "twice": "add"}


@dataclass(frozen=True)
class StraightLine:
    """A C function and what it costs."""

    code: str
    operations: Counter[str]
    """How often each of add, mul, div, sqrt, sin, atan2, ... is done in a call."""

    @property
    def functions(self) -> set[str]:
        """math.h's functions that are called, without suffix."""
        return set(self.operations) & set(FUNCTIONS.values())


def straight_line(
    function: "casadi.Function",
    name: str,
    inputs: Sequence[str],
    outputs: Sequence[str],
    precision: Precision,
    *,
    comment: str = "",
) -> StraightLine:
    """`function`, of dense SX arguments, as ``static void name(const vr_real *in..., vr_real *out...)``.

    `inputs` and `outputs` name its arguments; matrices lie column by column, as CasADi has them.
    """
    import casadi as ca

    symbols = function.sx_in()
    shared = ca.cse(list(function.call(symbols)))
    tape = tape_of(ca.Function(name, symbols, [ca.densify(out) for out in shared]))
    writer = _Writer(tape, inputs, outputs, precision)
    body = writer.lines()
    parameters = [f"const vr_real *{one}" for one in inputs] + [f"vr_real *{one}" for one in outputs]
    unused = [f"    (void){one};" for one in inputs if one not in writer.used]
    text = [f"/* {comment} */"] if comment else []
    text += [f"static void {name}({', '.join(parameters)})", "{", *body[0], *unused, *body[1], "}"]
    return StraightLine("\n".join(text) + "\n", writer.operations)


class _Writer:
    """Walks the tape; each result becomes a constant of its own name, for the compiler to place."""

    def __init__(self, tape: Tape, inputs: Sequence[str], outputs: Sequence[str], precision: Precision):
        self.tape, self.inputs, self.outputs, self.precision = tape, inputs, outputs, precision
        self.where: dict[int, str] = {}
        """What holds each register's value."""
        self.used: set[str] = set()
        self.operations: Counter[str] = Counter()

    def lines(self) -> tuple[list[str], list[str]]:
        """The constants' declarations, then the assignments to the outputs.

        Outputs are written last: they may lie where an input does.
        """
        declared, assigned = [], []
        for instruction in self.tape.instructions:
            op, at = instruction.op, instruction.at
            if op == "output":
                assigned.append(f"    {self.outputs[at[0]]}[{at[1]}] = {self.where[instruction.sources[0]]};")
            elif op == "input":
                self.used.add(self.inputs[at[0]])
                self.where[instruction.target] = f"{self.inputs[at[0]]}[{at[1]}]"
            elif op == "const":
                value = self.precision.literal(instruction.constant)
                self.where[instruction.target] = f"({value})" if value.startswith("-") else value
            else:
                text = self._expression(op, [self.where[source] for source in instruction.sources])
                name = self.where[instruction.target] = f"t{len(declared)}"
                declared.append(f"    const vr_real {name} = {text};")
        return declared, assigned

    def _expression(self, op: str, operands: Sequence[str]) -> str:
        self.operations[COUNTED_AS.get(op, op if op in INFIX or op in FUNCTIONS else "select")] += 1
        zero, one = self.precision.literal(0.0), self.precision.literal(1.0)
        if op in INFIX:
            return f" {INFIX[op]} ".join(operands)
        if op in COMPARISONS:
            return f"{operands[0]} {COMPARISONS[op]} {operands[1]} ? {one} : {zero}"
        if op in FUNCTIONS:
            return f"{self.precision.function(FUNCTIONS[op])}({', '.join(operands)})"
        if op not in OTHERS:
            raise BadParameter(
                "operation to write as C", op, ", ".join([*INFIX, *COMPARISONS, *FUNCTIONS, *OTHERS])
            )
        return OTHERS[op].format(*operands, zero=zero, one=one)
