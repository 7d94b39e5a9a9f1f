"""The instructions of a CasADi SX function, read off its tape, for other evaluators to run."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from casadi import Function

__all__ = ["Instruction", "Tape", "tape_of"]


@dataclass(frozen=True)
class Instruction:
    """``target = op(*sources)``; for input and output `at` says which number of which argument."""

    op: str
    """input, output, const, or the operation: add, mul, sin ..."""
    target: int
    sources: tuple[int, ...] = ()
    at: tuple[int, int] = (0, 0)
    constant: float = 0.0


@dataclass(frozen=True)
class Tape:
    """A straight program over `registers` numbers, reused as CasADi does."""

    name: str
    inputs: tuple[tuple[str, int], ...]
    """Name and count of numbers of each argument."""
    outputs: tuple[tuple[str, int], ...]
    registers: int
    instructions: tuple[Instruction, ...]


def tape_of(function: "Function") -> Tape:
    """The tape of an SX function; its outputs count their structural nonzeros."""
    import casadi as ca

    names = {getattr(ca, name): name[3:].lower() for name in dir(ca) if name.startswith("OP_")}
    instructions = []
    for k in range(function.n_instructions()):
        op = names[function.instruction_id(k)]
        sources, targets = function.instruction_input(k), function.instruction_output(k)
        if op == "input":
            instructions.append(Instruction(op, targets[0], at=(sources[0], sources[1])))
        elif op == "output":
            instructions.append(Instruction(op, -1, (sources[0],), at=(targets[0], targets[1])))
        elif op == "const":
            instructions.append(Instruction(op, targets[0], constant=float(function.instruction_constant(k))))
        else:
            instructions.append(Instruction(op, targets[0], tuple(sources)))
    return Tape(
        name=function.name(),
        inputs=tuple((function.name_in(i), function.nnz_in(i)) for i in range(function.n_in())),
        outputs=tuple((function.name_out(i), function.nnz_out(i)) for i in range(function.n_out())),
        registers=function.sz_w(),
        instructions=tuple(instructions),
    )
