"""Flow in a video, frame by frame, each estimate starting from the one before."""

from collections import deque

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.flow.estimate import FlowEstimator, FlowSettings
from vision_robot.flow.minimise import Minimum
from vision_robot.types import Array, Float

__all__ = ["FlowSequence"]


class FlowSequence:
    """Takes grey frames one at a time; remembers only as many as it compares with.

    Args:
        settings: As for `estimate_flow`.
        back: Which frame to compare with: 1 the one before, N the Nth back.
        to_past: Tell the flow from the new frame to the old one, which lies where things are now,
            instead of that from the old frame to the new.
    """

    def __init__(self, settings: FlowSettings | None = None, *, back: int = 1, to_past: bool = False):
        if back < 1:
            raise BadParameter("back", back, "1 or more")
        self._estimate = FlowEstimator(settings)
        self._frames: deque[Array] = deque(maxlen=back)
        self._to_past = to_past
        self._last: Float[Array, "2 h w"] | None = None

    def step(self, frame: Array) -> Minimum | None:
        """The flow between the frame `back` frames ago and this one; None for the first `back` frames."""
        old = self._frames[0] if len(self._frames) == self._frames.maxlen else None
        self._frames.append(np.array(frame))
        if old is None:
            return None
        pair = (frame, old) if self._to_past else (old, frame)
        result = self._estimate(*pair, start=self._last)
        self._last = result.flow
        return result
