"""CasADi functions as C on eight lanes: the tape of each with the vector types of `native/lanes.h`."""

from typing import TYPE_CHECKING

from vision_robot.arm.tape import tape_of

if TYPE_CHECKING:
    from casadi import Function

__all__ = ["lane_code"]

EXPRESSIONS = {
    "assign": "{0}",
    "add": "{0} + {1}",
    "sub": "{0} - {1}",
    "mul": "{0} * {1}",
    "div": "{0} / {1}",
    "neg": "-{0}",
    "sq": "{0} * {0}",
    "twice": "{0} + {0}",
    "inv": "V(1.0) / {0}",
    "sqrt": "v_sqrt({0})",
    "sin": "v_sin({0})",
    "cos": "v_cos({0})",
    "atan2": "v_atan2({0}, {1})",
    "floor": "v_floor({0})",
    "fabs": "v_fabs({0})",
    "fmin": "v_fmin({0}, {1})",
    "fmax": "v_fmax({0}, {1})",
    "lt": "truth({0} < {1})",
    "le": "truth({0} <= {1})",
    "eq": "truth({0} == {1})",
    "ne": "truth({0} != {1})",
    "and": "{0} * {1}",  # of zeros and ones
    "or": "v_fmax({0}, {1})",
    "not": "truth({0} == V(0.0))",
    "if_else_zero": "v_if({0}, {1})",
}


def lane_code(function: "Function") -> str:
    """A C function ``static void name(const vd *input, ..., vd *output, ...)`` of the same name."""
    tape = tape_of(function)
    inputs = [f"const vd *{name}" for name, _ in tape.inputs]
    outputs = [f"vd *{name}" for name, _ in tape.outputs]
    lines = [f"static void {tape.name}({', '.join([*inputs, *outputs])})", "{"]
    held: dict[int, str] = {}
    """Name of the variable that holds each register now: every value gets a name of its own."""
    for number, instruction in enumerate(tape.instructions):
        op, (argument, index) = instruction.op, instruction.at
        if op == "output":
            lines.append(f"    {tape.outputs[argument][0]}[{index}] = {held[instruction.sources[0]]};")
            continue
        if op == "input":
            value = f"{tape.inputs[argument][0]}[{index}]"
        elif op == "const":
            value = f"V({instruction.constant!r})"
        elif op in EXPRESSIONS:
            value = EXPRESSIONS[op].format(*(held[source] for source in instruction.sources))
        else:
            raise NotImplementedError(f"C form of CasADi's operation {op!r}")
        held[instruction.target] = f"t{number}"
        lines.append(f"    const vd t{number} = {value};")
    return "\n".join([*lines, "}", ""])
