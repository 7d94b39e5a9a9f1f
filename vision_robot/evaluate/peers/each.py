"""Several trackers of one object each, side by side, as one tracker of several objects."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.track.blobs import Blobs
from vision_robot.track.tracker import Remark, Tracker
from vision_robot.types import Array, Image, UInt8

__all__ = ["Each"]


@dataclass(frozen=True)
class EachOptions:
    """The trackers, which have seen nothing yet."""

    trackers: Sequence[Tracker] = ()

    def __post_init__(self) -> None:
        if not self.trackers:
            raise BadParameter("trackers", self.trackers, "one at least")


class Each(Tracker):
    """Every object by a tracker of its own; whose blob is whose is known by its kind."""

    name = "each"
    Options = EachOptions

    def __init__(self, options: EachOptions | None = None) -> None:
        self._trackers = (options or EachOptions()).trackers

    def find(self, frame: Image, time_s: float) -> Blobs:
        """What each of them finds."""
        found = [one.step(frame, time_s) for one in self._trackers]
        return Blobs.joined(
            [replace(blobs, kind=np.full(len(blobs), kind)) for kind, blobs in enumerate(found)]
        )

    @property
    def mask(self) -> UInt8[Array, "height width"]:
        """The pixels of the last one that claims them."""
        mask = np.zeros_like(self._trackers[0].mask)
        for kind, one in enumerate(self._trackers):
            mask[one.mask > 0] = 1 + kind
        return mask

    def remarks(self) -> tuple[Remark, ...]:
        """What each of them says."""
        return tuple(remark for one in self._trackers for remark in one.remarks())

    def figures(self) -> dict[str, float]:
        """None of its own."""
        return {}
