"""The expressions that the exported code calls, each as one C function."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vision_robot.arm import symbolic
from vision_robot.arm.export_c.precision import Precision
from vision_robot.arm.export_c.straight_line import StraightLine, straight_line
from vision_robot.arm.task import Task
from vision_robot.geometry import SerialChain

if TYPE_CHECKING:
    from casadi import Function

    from vision_robot.arm.closed_form import ClosedForm

__all__ = ["kernels_of", "representable"]


def kernels_of(
    chain: SerialChain, task: Task, real: Precision, closed: "ClosedForm | None"
) -> Mapping[str, StraightLine]:
    """What vr_ik.c needs, by name: forward and step; with a closed form branches and error, too."""
    forward = symbolic.base_from_tool(chain)
    step = symbolic.lm_step(chain, task)
    kernels = {
        "forward": straight_line(forward, "vr_kernel_forward", ["q"], ["pose"], real),
        "step": straight_line(step, "vr_kernel_step", ["q", "goal"], ["next", "error"], real),
    }
    if closed is not None:
        branches = _part(closed.function, "branches", 0)
        error = _part(symbolic.residual(chain, task), "error", 2)
        kernels["branches"] = straight_line(branches, "vr_kernel_branches", ["goal"], ["q"], real)
        kernels["error"] = straight_line(error, "vr_kernel_error", ["q", "goal"], ["error"], real)
    return kernels


def representable(chain: SerialChain, real: Precision) -> SerialChain:
    """The chain with its limits rounded inwards to numbers of this precision."""
    if real.bytes == 8:
        return chain
    limits = chain.limits.astype(np.float32)
    low, high = limits.T
    low = np.where(low < chain.limits[:, 0], np.nextafter(low, np.float32(np.inf)), low)
    high = np.where(high > chain.limits[:, 1], np.nextafter(high, np.float32(-np.inf)), high)
    return replace(chain, limits=np.stack([low, high], axis=1).astype(float))


def _part(function: "Function", name: str, output: int) -> "Function":
    """A function that gives one of the results only, so that nothing else is computed."""
    import casadi as ca

    symbols = function.sx_in()
    return ca.Function(name, symbols, [function.call(symbols)[output]])
