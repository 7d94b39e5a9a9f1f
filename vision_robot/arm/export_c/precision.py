"""How a real number is written in C, in single or double precision."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter

__all__ = ["DOUBLE", "PRECISIONS", "SINGLE", "Precision", "precision_named"]


@dataclass(frozen=True)
class Precision:
    """Type, constants and functions of one size of real."""

    name: str
    c_type: str
    suffix: str
    """Of constants and of math.h's functions: without it C computes in double."""
    bytes: int
    reached_m: float
    reached_rad: float
    """Within these of the goal an answer counts as reached."""
    fine_m: float
    fine_rad: float
    """Until these the search goes on; near where the arm is singular it may stay above them."""

    def literal(self, value: float) -> str:
        """`value` as a constant of this type, which reads back as the same number."""
        if not np.isfinite(value):
            return "VR_NAN" if np.isnan(value) else ("-" if value < 0 else "") + "VR_INFINITY"
        text = str(np.float32(value)) if self.suffix else repr(float(value))
        return text + self.suffix

    def function(self, name: str) -> str:
        """math.h's function of this type."""
        return name + self.suffix


SINGLE = Precision("single", "float", "f", 4, 1e-5, 1e-4, 5e-7, 2e-6)
DOUBLE = Precision("double", "double", "", 8, 1e-6, 1e-5, 1e-11, 1e-11)
PRECISIONS = {one.name: one for one in (SINGLE, DOUBLE)}


def precision_named(name: str) -> Precision:
    """The precision called `name`. Raises BadParameter, with those there are."""
    if name not in PRECISIONS:
        raise BadParameter("precision", name, " or ".join(PRECISIONS))
    return PRECISIONS[name]
