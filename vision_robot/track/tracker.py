"""What every tracker is: frames in, one at a time, blobs out."""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from typing import Any, ClassVar, final

from vision_robot.track.admission import Admission
from vision_robot.track.blobs import Blobs
from vision_robot.types import Array, Image, UInt8

__all__ = ["LooksAhead", "Remark", "Tracker"]

Remark = tuple[str, str]
"""A tone (good, note or caution) and a sentence."""


class Tracker(ABC):
    """Finds objects in a video from a fixed camera, frame by frame; its memory does not grow with the video.

    A tracker keeps what it has learned so far and is used for one video. What it can be told is a
    frozen dataclass of its own, `Options`, every field with a default; None stands for "choose from the
    data". It is built as ``cls(cls.Options(...))``; `vision_robot.track.registry` does so from a name.
    """

    name: ClassVar[str]
    """Name in the registry, on the command line and before the dot of its options."""

    Options: ClassVar[type[Any]]
    """The frozen dataclass of what can be asked of it."""

    _admission: Admission | None = None

    @abstractmethod
    def __init__(self, options: Any = None) -> None:
        """A tracker that has seen nothing; `options` is an instance of `Options`, None its defaults."""

    @final
    def step(self, frame: Array, time_s: float) -> Blobs:
        """The objects in the next frame of the video, taken `time_s` seconds after any fixed moment.

        Frames are blue-green-red; grey, 16-bit and transparent ones are converted. Raises BadFrame for
        what is no picture, has another size than the frames before, or does not come after them.
        """
        if self._admission is None:
            self._admission = Admission()
        return self.find(self._admission.admit(frame, time_s), time_s)

    @abstractmethod
    def find(self, frame: Image, time_s: float) -> Blobs:
        """What `step` answers, from a (height, width, 3) frame that fits to those before.

        The frame must neither be kept without a copy nor changed.
        """

    @property
    @abstractmethod
    def mask(self) -> UInt8[Array, "height width"]:
        """Pixels taken for objects in the last frame: 0 for background, else 1 + kind. For overlays."""

    @abstractmethod
    def remarks(self) -> tuple[Remark, ...]:
        """What was chosen from the data and how sure it is, in sentences: noise, separation, warnings."""

    @abstractmethod
    def figures(self) -> dict[str, float]:
        """The numbers behind the remarks, by name with unit (`noise_levels`, `min_area_px`)."""


class LooksAhead(ABC):
    """What a tracker is besides when it can learn from the beginning of a video before it answers for it.

    Only recorded videos can be looked ahead in; without it a tracker learns as it goes.
    """

    @abstractmethod
    def learn(self, frames: Iterable[tuple[Array, float]]) -> None:
        """See frames and their times [s] from the video's start, as many as are wanted.

        Frames are of any kind that `step` takes, and are given to it again afterwards.
        """
