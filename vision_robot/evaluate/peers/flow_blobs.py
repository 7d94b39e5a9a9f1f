"""OpenCV's dense optical flow with a threshold on its length, followed by blob analysis."""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.evaluate.peers.flow_methods import flow_method
from vision_robot.track.blob_analysis import analyse
from vision_robot.track.blobs import Blobs
from vision_robot.track.tracker import Remark, Tracker
from vision_robot.types import Array, Image, UInt8

__all__ = ["DisBlobs", "FarnebackBlobs", "FlowBlobsOptions"]


@dataclass(frozen=True)
class FlowBlobsOptions:
    """What is done with the flow."""

    threshold_px: float = 0.5
    """Longer flow from frame to frame is motion."""
    min_area_px: float = 30.0
    """Smaller blobs are noise."""
    closing_px: int = 3
    """Side of the square that closes gaps; 0 for none."""

    def __post_init__(self) -> None:
        for name in ("threshold_px", "min_area_px", "closing_px"):
            if not getattr(self, name) >= 0:
                raise BadParameter(name, getattr(self, name), "zero or positive")


class FlowBlobs(Tracker):
    """Length of the flow over a threshold, median filter, closing, blobs."""

    Options = FlowBlobsOptions

    def __init__(self, options: FlowBlobsOptions | None = None) -> None:
        self._options = options or FlowBlobsOptions()
        self._flow = self.method()
        self._before: Array | None = None
        self._mask = np.zeros((1, 1), np.uint8)

    @abstractmethod
    def method(self) -> Callable[[Array, Array], Array]:
        """What finds the flow between two grey pictures."""

    def find(self, frame: Image, time_s: float) -> Blobs:  # noqa: ARG002 - they know no time
        """Blobs of what moves."""
        grey, before = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY), self._before
        self._before = grey
        if before is None:
            self._mask = np.zeros(grey.shape, np.uint8)
            return Blobs.empty()
        flow = self._flow(before, grey)
        moving = np.hypot(flow[..., 0], flow[..., 1]) > self._options.threshold_px
        mask = cv2.medianBlur(moving.astype(np.uint8), 5)
        if self._options.closing_px:
            side = self._options.closing_px
            mask = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((side, side), np.uint8))
        self._mask = np.asarray(mask, dtype=np.uint8)
        return analyse(self._mask, min_area_px=self._options.min_area_px)

    @property
    def mask(self) -> UInt8[Array, "height width"]:
        """The cleaned mask."""
        return self._mask

    def remarks(self) -> tuple[Remark, ...]:
        """Nothing: it does not say."""
        return ()

    def figures(self) -> dict[str, float]:
        """Nothing: it chooses nothing."""
        return {}


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
