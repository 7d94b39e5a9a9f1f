"""Methods of dense optical flow by name: ours, the text's, OpenCV's."""

from collections.abc import Callable

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.flow import (
    FAST,
    FlowEstimator,
    FlowSettings,
    Multigrid,
    horn_schunck,
    horn_schunck_sweeps,
)
from vision_robot.types import Array, Float

__all__ = ["FLOW_METHODS", "FlowMethod", "flow_method"]

FlowMethod = Callable[[Array, Array], Float[Array, "h w 2"]]
"""Two grey pictures of bytes -> (du, dv) [px]."""


def flow_method(name: str) -> FlowMethod:
    """A method that has seen nothing, with the memory it keeps between pairs. Raises BadParameter."""
    if name not in FLOW_METHODS:
        raise BadParameter("flow method", name, f"one of {', '.join(FLOW_METHODS)}")
    return FLOW_METHODS[name]()


def _estimator(settings: FlowSettings) -> FlowMethod:
    estimate = FlowEstimator(settings)
    return lambda first, second: np.moveaxis(estimate(first, second).flow, 0, -1)


def _minimum() -> FlowMethod:
    grids: dict[tuple[int, int], Multigrid] = {}

    def method(first: Array, second: Array) -> Array:
        shape = (first.shape[0], first.shape[1])
        memory = grids.setdefault(shape, Multigrid(shape))
        return np.moveaxis(horn_schunck(first, second, grids=memory).flow, 0, -1)

    return method


def _sweeps() -> FlowMethod:
    return lambda first, second: np.moveaxis(horn_schunck_sweeps(first, second, sweeps=100), 0, -1)


def _farneback() -> FlowMethod:
    # The values of OpenCV's own example, with two more levels, without which 8 px are too far for it.
    return lambda first, second: cv2.calcOpticalFlowFarneback(
        first, second, np.zeros((*first.shape, 2), np.float32), 0.5, 5, 15, 3, 5, 1.2, 0
    )


def _dis(preset: int) -> FlowMethod:
    peer = cv2.DISOpticalFlow.create(preset)
    return lambda first, second: peer.calc(first, second, None)  # type: ignore[call-overload]


def _tvl1() -> FlowMethod:
    peer = cv2.optflow.DualTVL1OpticalFlow.create()
    return lambda first, second: peer.calc(first, second, None)  # type: ignore[call-overload]


def _zero() -> FlowMethod:
    return lambda first, _: np.zeros((*first.shape, 2), np.float32)


FLOW_METHODS: dict[str, Callable[[], FlowMethod]] = {
    "vr": lambda: _estimator(FlowSettings()),
    "vr-fast": lambda: _estimator(FAST),
    "horn-schunck": _minimum,
    "horn-schunck-100": _sweeps,
    "cv2-farneback": _farneback,
    "cv2-dis-ultrafast": lambda: _dis(cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST),
    "cv2-dis-fast": lambda: _dis(cv2.DISOPTICAL_FLOW_PRESET_FAST),
    "cv2-dis-medium": lambda: _dis(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM),
    "cv2-tvl1": _tvl1,
    "no-motion": _zero,
}
"""`horn-schunck` is the equations of 1981 solved to their minimum, `horn-schunck-100` the text's hundred
sweeps; `no-motion` answers zero everywhere: who is not better than that has found nothing."""
