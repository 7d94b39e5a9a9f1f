"""OpenCV's dense optical flow with a threshold on its length, followed by blob analysis."""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from vision_robot.evaluate.peers.flow_methods import flow_method
from vision_robot.evaluate.peers.mask_blobs import MaskBlobs, MaskOptions
from vision_robot.types import Array, Bool, Image

__all__ = ["DisBlobs", "FarnebackBlobs", "FlowBlobsOptions"]


@dataclass(frozen=True)
class FlowBlobsOptions(MaskOptions):
    """What is done with the flow."""

    threshold_px: float = 0.5
    """Longer flow from frame to frame is motion."""


class FlowBlobs(MaskBlobs):
    """Where flow is longer than a threshold."""

    Options = FlowBlobsOptions

    def __init__(self, options: Any = None) -> None:
        super().__init__(options)
        self._flow = self.method()
        self._before: Array | None = None

    @abstractmethod
    def method(self) -> Callable[[Array, Array], Array]:
        """What finds the flow between two grey pictures."""

    def raw(self, frame: Image) -> Bool[Array, "height width"]:
        """What moves; nothing in the first frame."""
        grey, before = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY), self._before
        self._before = grey
        if before is None:
            return np.zeros(grey.shape, dtype=bool)
        flow = self._flow(before, grey)
        return np.hypot(flow[..., 0], flow[..., 1]) > self._options.threshold_px


class FarnebackBlobs(FlowBlobs):
    """Polynomial expansion (Farneback 2003)."""

    name = "cv2-farneback"

    def method(self) -> Callable[[Array, Array], Array]:
        """As in suite flow."""
        return flow_method(self.name)


class DisBlobs(FlowBlobs):
    """Dense inverse search (Kroeger et al. 2016), the fast preset."""

    name = "cv2-dis"

    def method(self) -> Callable[[Array, Array], Array]:
        """As in suite flow."""
        return flow_method("cv2-dis-fast")
